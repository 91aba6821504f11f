#include "client/stream/pager.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include <gtest/gtest.h>

#include "client/stream/host_cache.h"
#include "tests/stream/fake_dataset.h"

namespace terray::test {
namespace {

/// Levels 0..1 of heights (5 tiles), 0..3 of imagery (85 tiles).
const FakeDataset& smallDataset() {
    static const FakeDataset dataset =
        buildDataset([](int64_t x, int64_t y) { return 100 + 0.1 * static_cast<double>(x % 64 + y % 48); },
                     {.samples = {1024, 1024}, .imageryLevel = 3});
    return dataset;
}

/// All tiles of a dataset, heights first.
std::vector<TileRequest> allTiles(const FakeDataset& dataset) {
    std::vector<TileRequest> all;
    for (const auto& [id, tile] : dataset.heights) all.push_back({TileLayer::heights, id, 1});
    for (const auto& [id, tile] : dataset.imagery) all.push_back({TileLayer::imagery, id, 1});
    return all;
}

/// How a tile arrives.
enum class Fate { fine, failsOnce, truncatedOnce, corruptOnce, failsAlways, truncatedAlways, corruptAlways };

/// Serves a dataset with faults that depend on the seed and the tile alone; counts; can be held back.
class FaultySource : public TileSource {
  public:
    FaultySource(const FakeDataset& dataset, uint64_t seed, double faults)
        : dataset_(dataset), whole_(dataset), seed_(seed), faults_(faults) {}

    const DatasetMetadata& metadata() const override { return dataset_.metadata; }
    std::string contentHash() const override { return "faulty"; }
    Result<Bytes> read(TileLayer layer, const TileId& id) const override {
        const TileKey key{layer, id};
        int reads = 0;
        {
            std::unique_lock lock(mutex_);
            gate_.wait(lock, [this] { return open_; });
            reads = ++reads_[key];
            order_.push_back(key);
        }
        Random random(seed_ ^ TileKeyHash()(key) ^ static_cast<uint64_t>(reads));
        if (faults_ > 0 && random.chance(0.3))
            std::this_thread::sleep_for(std::chrono::microseconds(random.next() % 500));
        auto payload = whole_.read(layer, id);
        const Fate fate = fateOf(key);
        const bool always = fate >= Fate::failsAlways;
        if (!payload || fate == Fate::fine || (!always && reads > 1)) return payload;
        if (fate == Fate::failsOnce || fate == Fate::failsAlways) return Failure{"the disk says no"};
        if (fate == Fate::truncatedOnce || fate == Fate::truncatedAlways)
            payload->resize(random.next() % payload->size());
        else
            (*payload)[random.next() % payload->size()] ^= std::byte(1u << random.next() % 8);
        return payload;
    }

    Fate fateOf(const TileKey& key) const {
        Random random(seed_ + TileKeyHash()(key));
        if (!random.chance(faults_)) return Fate::fine;
        return static_cast<Fate>(1 + random.next() % 6);
    }
    /// Whether the tile can be had, and for a photo all that it needs.
    bool available(const TileRequest& request) const {
        for (uint32_t up = 0; up <= std::min(request.id.level, request.layer == TileLayer::imagery ? 3u : 0u); ++up)
            if (fateOf({request.layer, request.id.ancestor(up)}) >= Fate::failsAlways) return false;
        return true;
    }
    int reads(const TileKey& key) const {
        const std::lock_guard lock(mutex_);
        const auto found = reads_.find(key);
        return found == reads_.end() ? 0 : found->second;
    }
    std::vector<TileKey> order() const {
        const std::lock_guard lock(mutex_);
        return order_;
    }
    void setOpen(bool open) {
        {
            const std::lock_guard lock(mutex_);
            open_ = open;
        }
        gate_.notify_all();
    }

  private:
    const FakeDataset& dataset_;
    FakeSource whole_;
    uint64_t seed_;
    double faults_;
    mutable std::mutex mutex_;
    mutable std::condition_variable gate_;
    bool open_ = true;
    mutable std::unordered_map<TileKey, int, TileKeyHash> reads_;
    mutable std::vector<TileKey> order_;
};

void expectBalanced(const PagerStatistics& count) {
    EXPECT_EQ(count.requested + count.hostHits, count.delivered + count.failed + count.cancelled);
}

void expectWhole(const FakeDataset& dataset, const LoadedTile& tile) {
    if (tile.layer == TileLayer::heights) {
        ASSERT_TRUE(tile.heights);
        EXPECT_TRUE(*tile.heights == dataset.heights.at(tile.id)) << tile.id;
        return;
    }
    ASSERT_TRUE(tile.imagery && tile.imageryChain);
    const ImageryTile& expected = dataset.imagery.at(tile.id);
    EXPECT_TRUE(*tile.imagery == expected) << tile.id;
    std::vector<const ImageryTile*> ancestors;
    for (uint32_t up = 1; up <= std::min(tile.id.level, 3u); ++up)
        ancestors.push_back(&dataset.imagery.at(tile.id.ancestor(up)));
    EXPECT_TRUE(*tile.imageryChain == gatherMipChain(expected, ancestors)) << tile.id;
}

TEST(Pager, DeliversEveryWantedTileOnceAndWhole) {
    const FakeDataset& dataset = smallDataset();
    const FaultySource source(dataset, 1, 0);
    Pager pager(source, {.decodeThreads = 2});
    const auto all = allTiles(dataset);
    pager.want(all);
    pager.waitUntilSettled();
    const auto loaded = pager.takeLoaded(1000);
    ASSERT_EQ(loaded.size(), all.size());
    for (const LoadedTile& tile : loaded) expectWhole(dataset, tile);
    EXPECT_TRUE(pager.takeLoaded(1000).empty());
    EXPECT_TRUE(pager.takeFailed().empty());
    for (const TileRequest& request : all) EXPECT_EQ(source.reads({request.layer, request.id}), 1) << request.id;
    const PagerStatistics count = pager.statistics();
    EXPECT_EQ(count.requested, all.size());
    EXPECT_EQ(count.delivered, all.size());
    EXPECT_GT(count.bytesRead, 0u);
    expectBalanced(count);
}

TEST(Pager, SettlesEveryRequestExactlyOnceWhateverTheSourceDoes) {
    const FakeDataset& dataset = smallDataset();
    const auto all = allTiles(dataset);
    for (uint64_t seed = 1; seed <= 6; ++seed) {
        const FaultySource source(dataset, seed, 0.25);
        Random random(seed);
        // Budgets from hopeless to ample.
        const uint64_t budget = seed % 3 == 0 ? 1 : seed % 3 == 1 ? 2000000 : 1u << 30;
        Pager pager(
            source,
            {.hostBudgetBytes = budget, .decodeThreads = 1 + static_cast<int>(seed % 3), .maxRequestsInFlight = 4});
        std::vector<LoadedTile> loaded;
        std::vector<FailedTile> failed;
        const auto collect = [&] {
            for (LoadedTile& tile : pager.takeLoaded(3)) loaded.push_back(std::move(tile));
            for (FailedTile& tile : pager.takeFailed()) failed.push_back(std::move(tile));
        };
        for (int frame = 0; frame < 30; ++frame) {
            std::vector<TileRequest> some;
            for (const TileRequest& request : all)
                if (random.chance(0.3)) some.push_back(request);
            pager.want(some);
            if (random.chance(0.5)) std::this_thread::sleep_for(std::chrono::microseconds(random.next() % 2000));
            collect();
        }
        pager.want(all);
        pager.waitUntilSettled();
        while (true) {
            const size_t before = loaded.size();
            collect();
            if (loaded.size() == before) break;
        }
        const PagerStatistics count = pager.statistics();
        expectBalanced(count);
        EXPECT_EQ(count.delivered, loaded.size());
        EXPECT_EQ(count.failed, failed.size());
        for (const TileRequest& request : all) {
            const auto same = [&](const auto& tile) { return tile.layer == request.layer && tile.id == request.id; };
            EXPECT_EQ(std::any_of(loaded.begin(), loaded.end(), same), source.available(request)) << request.id;
            EXPECT_EQ(std::count_if(failed.begin(), failed.end(), same), source.available(request) ? 0 : 1)
                << request.id;
        }
        for (const LoadedTile& tile : loaded) expectWhole(dataset, tile);
    }
}

TEST(Pager, ReadsADamagedTileOnceMoreAndThenNeverAgain) {
    const FakeDataset& dataset = smallDataset();
    const FaultySource source(dataset, 5, 1);  // every tile has some fault
    Pager pager(source, {});
    const auto all = allTiles(dataset);
    for (int round = 0; round < 2; ++round) {
        pager.want(all);
        pager.waitUntilSettled();
    }
    int twice = 0;
    for (const auto& [id, tile] : dataset.heights) {
        EXPECT_EQ(source.reads({TileLayer::heights, id}), 2) << id;
        ++twice;
    }
    EXPECT_EQ(twice, 5);
    for (const FailedTile& tile : pager.takeFailed()) {
        EXPECT_NE(tile.message.find(toString(tile.id)), std::string::npos) << tile.message;
        EXPECT_NE(tile.message.find("tile"), std::string::npos) << tile.message;
    }
    pager.want(all);
    pager.waitUntilSettled();
    EXPECT_TRUE(pager.takeFailed().empty()) << "a failure is told once";
}

TEST(Pager, JoinsDuplicates) {
    FaultySource source(smallDataset(), 1, 0);
    Pager pager(source, {});
    source.setOpen(false);
    const TileRequest request{TileLayer::heights, {1, 0, 1}, 1};
    for (int frame = 0; frame < 50; ++frame) pager.want({request, request});
    source.setOpen(true);
    pager.waitUntilSettled();
    pager.want({request});  // delivered and not yet taken: still the same request
    pager.waitUntilSettled();
    EXPECT_EQ(pager.takeLoaded(10).size(), 1u);
    EXPECT_EQ(source.reads({TileLayer::heights, {1, 0, 1}}), 1);
    EXPECT_EQ(pager.statistics().requested, 1u);
}

TEST(Pager, AnswersFromMainMemoryWhatItHolds) {
    const FakeDataset& dataset = smallDataset();
    const FaultySource source(dataset, 1, 0);
    Pager pager(source, {});
    const std::vector<TileRequest> wanted{{TileLayer::heights, {1, 1, 1}, 1}, {TileLayer::imagery, {3, 5, 2}, 1}};
    for (int round = 0; round < 3; ++round) {
        pager.want(wanted);
        pager.waitUntilSettled();
        const auto loaded = pager.takeLoaded(10);
        ASSERT_EQ(loaded.size(), 2u);
        for (const LoadedTile& tile : loaded) expectWhole(dataset, tile);
    }
    EXPECT_EQ(pager.statistics().hostHits, 4u);
    EXPECT_EQ(source.order().size(), 5u) << "one height tile, one photo tile with three ancestors";
    expectBalanced(pager.statistics());
}

TEST(Pager, ReadsMostUrgentFirstAndAncestorsBeforeAPhoto) {
    FaultySource source(smallDataset(), 1, 0);
    source.setOpen(false);
    Pager pager(source, {.maxRequestsInFlight = 1});
    pager.want({{TileLayer::heights, {1, 1, 0}, 9}, {TileLayer::imagery, {2, 3, 3}, 5}, {TileLayer::heights, {}, 1}});
    source.setOpen(true);
    pager.waitUntilSettled();
    const std::vector<TileKey> expected{{TileLayer::heights, {1, 1, 0}},
                                        {TileLayer::imagery, {}},
                                        {TileLayer::imagery, {1, 1, 1}},
                                        {TileLayer::imagery, {2, 3, 3}},
                                        {TileLayer::heights, {}}};
    EXPECT_TRUE(source.order() == expected);
}

TEST(Pager, CancelsWhatIsNoLongerWantedAndNotYetBegun) {
    FaultySource source(smallDataset(), 1, 0);
    source.setOpen(false);
    Pager pager(source, {.maxRequestsInFlight = 1});
    const auto all = allTiles(smallDataset());
    pager.want(all);
    pager.want({all[3]});
    pager.want({});
    source.setOpen(true);
    pager.waitUntilSettled();
    const PagerStatistics count = pager.statistics();
    EXPECT_GE(count.cancelled, all.size() - 2) << "all but what may have been begun";
    expectBalanced(count);
    EXPECT_EQ(pager.takeLoaded(1000).size(), count.delivered);
}

TEST(Pager, DoesNotGatherTilesThatNobodyTakes) {
    const FakeDataset& dataset = smallDataset();
    const FaultySource source(dataset, 1, 0);
    Pager pager(source, {.decodeThreads = 2});
    for (const TileRequest& request : allTiles(dataset)) {  // a flight on which each frame wants another tile
        pager.want({request});
        pager.waitUntilSettled();
        expectBalanced(pager.statistics());
    }
    const TileRequest last = allTiles(dataset).back();
    EXPECT_EQ(pager.statistics().delivered, 1u);
    const auto loaded = pager.takeLoaded(1000);
    ASSERT_EQ(loaded.size(), 1u);
    EXPECT_EQ(loaded[0].id, last.id);
    pager.want({last});  // what was taken before is delivered again, what was dropped comes from main memory
    pager.want(allTiles(dataset));
    pager.waitUntilSettled();
    EXPECT_EQ(pager.takeLoaded(1000).size(), allTiles(dataset).size());
    EXPECT_EQ(source.order().size(), allTiles(dataset).size()) << "nothing was read twice";
    expectBalanced(pager.statistics());
}

TEST(Pager, KeepsToItsBudgetAndGoesOnWhenThatIsTiny) {
    const FakeDataset& dataset = smallDataset();
    const auto all = allTiles(dataset);
    const uint64_t one = hostBytesOf({TileLayer::heights, {}});
    for (const uint64_t budget : {uint64_t{0}, one, 3 * one}) {
        const FaultySource source(dataset, 1, 0);
        Pager pager(source, {.hostBudgetBytes = budget, .decodeThreads = 2});
        pager.want(all);
        size_t taken = 0;
        for (; taken < all.size(); taken += pager.takeLoaded(2).size()) {
            EXPECT_LE(pager.statistics().hostBytes, budget);
            std::this_thread::yield();
        }
        pager.waitUntilSettled();
        EXPECT_LE(pager.statistics().hostBytes, budget);
        EXPECT_GT(pager.statistics().evicted, 0u);
        expectBalanced(pager.statistics());
    }
}

TEST(Pager, EndsWithRequestsInFlight) {
    const FaultySource source(smallDataset(), 3, 0.5);
    for (int round = 0; round < 10; ++round) {
        Pager pager(source, {.decodeThreads = 2});
        pager.want(allTiles(smallDataset()));
    }
    Pager idle(source, {});
    idle.waitUntilSettled();
}

TEST(HostCache, LetsTheLeastRecentlyUsedGoButNoTileBeforeItsDescendants) {
    const auto key = [](uint32_t level, uint32_t x, uint32_t y) { return TileKey{TileLayer::imagery, {level, x, y}}; };
    const HeldTile tile{.bytes = 10};
    HostCache cache;
    cache.insert(key(3, 0, 0), tile);
    cache.insert(key(1, 0, 0), tile);
    cache.insert(key(1, 1, 1), tile);
    cache.insert(key(2, 0, 0), tile);
    EXPECT_EQ(cache.bytes(), 40u);
    EXPECT_NE(cache.use(key(1, 1, 1)), nullptr);
    EXPECT_NE(cache.use(key(3, 0, 0)), nullptr);  // and so 2/0/0 and 1/0/0
    EXPECT_EQ(cache.shrinkTo(30), 1u);
    EXPECT_FALSE(cache.holds(key(1, 1, 1)));
    EXPECT_EQ(cache.shrinkTo(25), 1u);
    EXPECT_FALSE(cache.holds(key(3, 0, 0))) << "before its ancestors";
    EXPECT_EQ(cache.shrinkTo(0), 2u);
    EXPECT_EQ(cache.use(key(1, 0, 0)), nullptr);
    EXPECT_EQ(cache.bytes(), 0u);
}

TEST(HostCache, ReplacesATileOfTheSameKey) {
    HostCache cache;
    cache.insert({TileLayer::heights, {}}, {.bytes = 10});
    cache.insert({TileLayer::heights, {}}, {.bytes = 30});
    EXPECT_EQ(cache.bytes(), 30u);
    EXPECT_FALSE(cache.holds({TileLayer::imagery, {}})) << "layers are apart";
}

}  // namespace
}  // namespace terray::test
