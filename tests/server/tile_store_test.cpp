// The cache of tiles: one read for many requests, its budget, reading ahead.
#include "server/tile_store.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include <gtest/gtest.h>
#include <sys/mman.h>

#include "tests/common/random.h"
#include "tests/common/temporary_directory.h"
#include "tests/server/small_dataset.h"

namespace terray::server {
namespace {

/// What each of these tiles takes: a page, and 256 bytes for keeping it.
const uint64_t kCost = TileMemory::roomFor(300) + 256;

/// A file whose reads of tiles can be held up, made to fail, and are counted.
class GatedSource final : public ByteSource {
  public:
    struct Gate {
        std::mutex mutex;
        std::condition_variable opened;
        bool isOpen = true;
        std::atomic<bool> fails = false;
        std::atomic<int> reads = 0;

        void open() {
            const std::lock_guard lock(mutex);
            isOpen = true;
            opened.notify_all();
        }
        void close() {
            const std::lock_guard lock(mutex);
            isOpen = false;
        }
    };
    GatedSource(std::unique_ptr<ByteSource> file, Gate& gate) : file_(std::move(file)), gate_(gate) {}
    Result<Bytes> read(uint64_t offset, uint64_t length) const override {
        ++gate_.reads;
        std::unique_lock lock(gate_.mutex);
        gate_.opened.wait(lock, [&] { return gate_.isOpen; });
        if (gate_.fails) return Failure{"the disk is broken"};
        return file_->read(offset, length);
    }
    uint64_t size() const override { return file_->size(); }
    std::string name() const override { return "gated"; }
    std::optional<int> descriptor() const override { return file_->descriptor(); }

  private:
    std::unique_ptr<ByteSource> file_;
    Gate& gate_;
};

class Tiles : public testing::Test {
  protected:
    Tiles() {
        writeSmallDataset(directory_ / "d");
        auto file = openFileSource(directory_ / "d" / "imagery.pmtiles").value();
        archive_ = ServedArchive::open(std::make_unique<GatedSource>(std::move(file), gate_)).value();
        gate_.reads = 0;
    }
    [[nodiscard]] StoredTile tile(const TileId& id) const {
        return {archive_, id, archive_->reader().locate(id).value().value()};
    }
    /// Reads and waits.
    TileBytes get(TileStore& store, const TileId& id) {
        if (TileBytes kept = store.find(tile(id))) return kept;
        std::atomic<bool> isDone = false;
        TileBytes bytes;
        store.read(tile(id), [&](TileBytes found) {
            bytes = std::move(found);
            isDone = true;
        });
        while (!isDone) std::this_thread::yield();
        return bytes;
    }
    static std::string text(const TileBytes& bytes) {
        return bytes ? std::string(reinterpret_cast<const char*>(bytes->bytes().data()), bytes->size()) : "";
    }
    static void waitFor(const std::atomic<uint64_t>& counter, uint64_t value) {
        while (counter < value) std::this_thread::yield();
    }

    test::TemporaryDirectory directory_;
    GatedSource::Gate gate_;
    Metrics metrics_;
    std::shared_ptr<const ServedArchive> archive_;
};

TEST_F(Tiles, AreReadOnceForAllWhoWait) {
    TileStore store({.readsAhead = false}, metrics_);
    gate_.close();
    std::mutex mutex;
    std::vector<TileBytes> answers;
    for (int i = 0; i < 10; ++i)
        store.read(tile({2, 1, 1}), [&](TileBytes bytes) {
            const std::lock_guard lock(mutex);
            answers.push_back(std::move(bytes));
        });
    gate_.open();
    for (size_t count = 0; count < 10;) {
        const std::lock_guard lock(mutex);
        count = answers.size();
    }
    EXPECT_EQ(1, gate_.reads);
    EXPECT_EQ(1, metrics_.tileReads);
    EXPECT_EQ(9, metrics_.tileJoins);
    EXPECT_EQ(smallTile("imagery", {2, 1, 1}), text(answers.front()));
    for (const TileBytes& bytes : answers) EXPECT_EQ(answers.front(), bytes) << "the same memory for all";
    EXPECT_EQ(answers.front(), store.find(tile({2, 1, 1})));
}

TEST_F(Tiles, ThatCannotBeReadSettleEveryRequestAndAreTriedAgain) {
    TileStore store({.readsAhead = false}, metrics_);
    gate_.close();
    gate_.fails = true;
    std::atomic<int> failures = 0;
    for (int i = 0; i < 5; ++i)
        store.read(tile({1, 0, 1}), [&](TileBytes bytes) { failures += bytes == nullptr ? 1 : 0; });
    gate_.open();
    while (failures < 5) std::this_thread::yield();
    gate_.fails = false;
    EXPECT_EQ(smallTile("imagery", {1, 0, 1}), text(get(store, {1, 0, 1})));
}

TEST_F(Tiles, StayWithinTheBudgetAndThoseAskedForLastStay) {
    const uint64_t budget = 5 * kCost;
    TileStore store({.budgetBytes = budget, .readsAhead = false}, metrics_);
    for (uint32_t x = 0; x < 7; ++x) {
        EXPECT_EQ(smallTile("imagery", {3, x, 0}), text(get(store, {3, x, 0})));
        EXPECT_LE(metrics_.cacheBytes, budget);
        EXPECT_NE(nullptr, store.find(tile({3, 0, 0}))) << "asked for again and again";
    }
    EXPECT_GT(metrics_.tileEvictions, 0);
    EXPECT_NE(nullptr, store.find(tile({3, 6, 0})));
    EXPECT_EQ(nullptr, store.find(tile({3, 1, 0})));
}

TEST_F(Tiles, GiveTheirMemoryBackWhenNobodyHoldsThem) {
    TileStore store({.budgetBytes = 2 * kCost, .readsAhead = false}, metrics_);
    const TileBytes held = get(store, {3, 0, 0});
    for (uint32_t x = 1; x < 7; ++x) (void)get(store, {3, x, 0});
    EXPECT_EQ(smallTile("imagery", {3, 0, 0}), text(held)) << "dropped from the cache, but not from here";
    std::array<unsigned char, 7> isThere{};  // all in one block, a page each
    auto* const first = const_cast<std::byte*>(held->bytes().data());
    ASSERT_EQ(0, ::mincore(first, 7 * TileMemory::roomFor(300), isThere.data()));
    EXPECT_EQ(3, std::count(isThere.begin(), isThere.end(), 1)) << "two kept, one held";
}

TEST_F(Tiles, MakeTheirChildrenBeReadAhead) {
    TileStore store({}, metrics_);
    (void)get(store, {1, 0, 0});
    waitFor(metrics_.aheadReads, 4);
    // Counted before it is read: the tile itself shows that it is there.
    while (store.find(tile({2, 1, 1})) == nullptr) std::this_thread::yield();
    EXPECT_EQ(1, metrics_.aheadUsed);
    EXPECT_EQ(1, metrics_.tileReads);
    waitFor(metrics_.aheadReads, 8);  // and now its children: a client comes nearer
    EXPECT_EQ(nullptr, store.find(tile({2, 3, 0}))) << "not those of others";
}

TEST_F(Tiles, ReadAheadTakeAQuarterOfTheBudgetAtMost) {
    const uint64_t budget = 8 * kCost;
    TileStore store({.budgetBytes = budget}, metrics_);
    const TileBytes root = get(store, {0, 0, 0});
    const TileBytes parent = get(store, {1, 0, 0});
    waitFor(metrics_.aheadReads, 4);
    EXPECT_LE(metrics_.cacheBytes, 2 * kCost + budget / 4);
    EXPECT_NE(nullptr, store.find(tile({0, 0, 0})));
}

TEST_F(Tiles, OfOneArchiveAreNeverTakenForThoseOfAnother) {
    const auto other = ServedArchive::open(directory_ / "d" / "heights.pmtiles").value();
    TileStore store({}, metrics_);
    (void)get(store, {1, 1, 0});
    EXPECT_EQ(nullptr, store.find({other, {1, 1, 0}, other->reader().locate({1, 1, 0}).value().value()}));
}

TEST_F(Tiles, AreRightForManyThreadsAtOnce) {
    const uint64_t budget = 15 * kCost;
    TileStore store({.budgetBytes = budget, .readers = 3}, metrics_);
    std::vector<std::thread> threads;
    std::atomic<int> wrong = 0;
    for (uint64_t seed = 1; seed <= 4; ++seed)
        threads.emplace_back([&, seed] {
            test::Random random(seed);
            for (int i = 0; i < 2000; ++i) {
                const TileId id = tileFromHilbert(random.below(60)).value();
                if (kEmptyTile.covers(id)) continue;
                if (text(get(store, id)) != smallTile("imagery", id)) ++wrong;
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(0, wrong);
    EXPECT_LE(metrics_.cacheBytes, budget);
}

}  // namespace
}  // namespace terray::server
