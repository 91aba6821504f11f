#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "client/stream/pager.h"
#include "tests/stream/fake_dataset.h"

namespace terray::test {
namespace {

const TileRequest kA{TileLayer::heights, {1, 0, 0}, 1};
const TileRequest kB{TileLayer::heights, {1, 1, 0}, 1};
const TileRequest kC{TileLayer::heights, {1, 0, 1}, 1};
const TileRequest kPhoto{TileLayer::imagery, {3, 5, 2}, 1};
const TileRequest kSibling{TileLayer::imagery, {3, 4, 2}, 1};

/// Levels 0..1 of heights, 0..3 of imagery.
const FakeDataset& dataset() {
    static const FakeDataset made =
        buildDataset([](int64_t x, int64_t y) { return 0.1 * static_cast<double>(x % 64 + y % 48); },
                     {.samples = {1024, 1024}, .imageryLevel = 3});
    return made;
}

/// Remembers the order of reads; can be held back, and fail.
class WatchedSource : public FakeSource {
  public:
    WatchedSource() : FakeSource(dataset()) {}
    Result<Bytes> read(TileLayer layer, const TileId& id) const override {
        std::unique_lock lock(mutex_);
        order_.push_back(id);
        gate_.wait(lock, [this] { return open_; });
        if (broken_.contains(id)) return Failure{"the disk says no"};
        return FakeSource::read(layer, id);
    }
    std::vector<TileId> order() const {
        const std::lock_guard lock(mutex_);
        return order_;
    }
    void setOpen(bool open) {
        const std::lock_guard lock(mutex_);
        open_ = open;
        gate_.notify_all();
    }
    void breakTile(const TileId& id) { broken_.insert(id); }

  private:
    mutable std::mutex mutex_;
    mutable std::condition_variable gate_;
    mutable std::vector<TileId> order_;
    bool open_ = true;
    std::set<TileId> broken_;
};

template <class Condition>
void waitFor(const Condition& condition) {
    for (int n = 0; n < 5000 && !condition(); ++n) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ASSERT_TRUE(condition());
}

void expectBalanced(const PagerStatistics& count) {
    EXPECT_EQ(count.requested + count.hostHits, count.delivered + count.failed + count.cancelled);
}

TEST(Prefetch, HoldsWhatIsReadAheadUntilItIsWanted) {
    const WatchedSource source;
    Pager pager(source, {});
    pager.want({}, {kA, kB});
    waitFor([&] { return pager.statistics().prefetch.tiles == 2; });
    EXPECT_TRUE(pager.takeLoaded(10).empty()) << "nobody wants it yet";
    const auto told = pager.takeAhead();
    ASSERT_EQ(told.size(), 2u);
    EXPECT_TRUE(*told[0].heights == dataset().heights.at(kA.id));
    EXPECT_EQ(pager.statistics().prefetch.usedTiles, 0u);

    pager.want({kA});
    pager.waitUntilSettled();
    EXPECT_EQ(pager.takeLoaded(10).size(), 1u);
    const PagerStatistics count = pager.statistics();
    EXPECT_EQ(count.hostHits, 1u);
    EXPECT_EQ(count.prefetch.answered, 1u);
    EXPECT_EQ(count.prefetch.usedTiles, 1u);
    EXPECT_GT(count.prefetch.usedBytes, 0u);
    EXPECT_LT(count.prefetch.usedBytes, count.prefetch.bytes) << "the other was of no use so far";
    EXPECT_EQ(source.order().size(), 2u);
    expectBalanced(count);
}

TEST(Prefetch, ComesAfterAllThatIsWanted) {
    WatchedSource source;
    source.setOpen(false);
    Pager pager(source, {.maxRequestsInFlight = 1});
    pager.want({}, {kA});
    waitFor([&] { return source.order().size() == 1; });
    pager.want({kPhoto, kB}, {kC});
    source.setOpen(true);
    waitFor([&] { return pager.statistics().prefetch.tiles == 2; });
    const auto order = source.order();
    EXPECT_EQ(order.front(), kA.id) << "it was under way";
    EXPECT_EQ(order.back(), kC.id);
    EXPECT_EQ(order.size(), 7u) << "a photo with three ancestors, and three height tiles";
}

TEST(Prefetch, JoinsAReadThatBecomesWanted) {
    WatchedSource source;
    source.setOpen(false);
    Pager pager(source, {});
    pager.want({}, {kPhoto});
    waitFor([&] { return !source.order().empty(); });
    pager.want({kPhoto});
    source.setOpen(true);
    pager.waitUntilSettled();
    EXPECT_EQ(pager.takeLoaded(10).size(), 1u);
    EXPECT_EQ(source.order().size(), 4u) << "nothing was read twice";
    EXPECT_EQ(pager.statistics().prefetch.joined, 1u);
    EXPECT_EQ(pager.statistics().prefetch.tiles, 0u);
    expectBalanced(pager.statistics());
}

TEST(Prefetch, BringsAPhotosAncestorsWhichCountAsUsedByItsSiblings) {
    const WatchedSource source;
    Pager pager(source, {});
    pager.want({}, {kPhoto});
    waitFor([&] { return pager.statistics().prefetch.tiles == 4; });
    pager.want({kSibling});
    pager.waitUntilSettled();
    EXPECT_EQ(pager.statistics().prefetch.usedTiles, 3u);
    EXPECT_EQ(pager.statistics().prefetch.answered, 0u);
    EXPECT_EQ(source.order().size(), 5u);
}

TEST(Prefetch, FailsInSilenceAndIsNotRepeatedUntilItIsWanted) {
    WatchedSource source;
    source.breakTile(kA.id);
    Pager pager(source, {});
    for (int frame = 0; frame < 20; ++frame) {
        pager.want({}, {kA});
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    waitFor([&] { return pager.statistics().prefetch.failed == 1; });
    EXPECT_EQ(source.order().size(), 2u) << "read once more, then not again";
    EXPECT_TRUE(pager.takeFailed().empty());
    pager.want({kA});
    pager.waitUntilSettled();
    EXPECT_EQ(pager.takeFailed().size(), 1u);
    expectBalanced(pager.statistics());
}

TEST(Prefetch, ReadsNothingAgainThatMemoryHadNoRoomFor) {
    const WatchedSource source;
    Pager pager(source, {.hostBudgetBytes = 1});
    for (int frame = 0; frame < 20; ++frame) {
        pager.want({}, {kA, kB});
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    waitFor([&] { return pager.statistics().prefetch.tiles == 2; });
    EXPECT_EQ(source.order().size(), 2u);
}

}  // namespace
}  // namespace terray::test
