#include "common/tile_id.h"

#include <cstdlib>
#include <unordered_set>

#include <gtest/gtest.h>

#include "common/pmtiles.h"
#include "common/tiling.h"
#include "tests/common/random.h"

namespace terray {
namespace {

using test::Random;

TileId randomTile(Random& random, uint32_t level) {
    const uint64_t side = uint64_t{1} << level;
    return {level, static_cast<uint32_t>(random.below(side)), static_cast<uint32_t>(random.below(side))};
}

TEST(TileId, ParentsAndChildrenAgree) {
    Random random(1);
    for (int i = 0; i < 1000; ++i) {
        const TileId id = randomTile(random, static_cast<uint32_t>(random.below(kMaxTileLevel)));
        for (uint32_t quadrant = 0; quadrant < 4; ++quadrant) {
            const TileId child = id.child(quadrant);
            EXPECT_TRUE(child.valid());
            EXPECT_EQ(child.parent(), id);
            EXPECT_EQ(child.quadrant(), quadrant);
            EXPECT_TRUE(id.covers(child));
            EXPECT_FALSE(child.covers(id));
        }
        EXPECT_EQ(id.ancestor(id.level), (TileId{0, 0, 0}));
        EXPECT_EQ(id.ancestor(0), id);
    }
}

TEST(TileId, NumbersQuadrantsFromTheNorthWest) {
    const TileId root;
    EXPECT_EQ(root.child(0), (TileId{1, 0, 0}));
    EXPECT_EQ(root.child(1), (TileId{1, 1, 0}));
    EXPECT_EQ(root.child(2), (TileId{1, 0, 1}));
    EXPECT_EQ(root.child(3), (TileId{1, 1, 1}));
}

TEST(TileId, KnowsWhichIdsCanExist) {
    EXPECT_TRUE((TileId{0, 0, 0}).valid());
    EXPECT_FALSE((TileId{0, 1, 0}).valid());
    EXPECT_TRUE((TileId{31, 0x7FFFFFFF, 0x7FFFFFFF}).valid());
    EXPECT_FALSE((TileId{31, 0x80000000, 0}).valid());
    EXPECT_FALSE((TileId{32, 0, 0}).valid());
    EXPECT_FALSE((TileId{0xFFFFFFFF, 0, 0}).valid());
}

TEST(TileId, HashesNeighboursApart) {
    std::unordered_set<size_t> hashes;
    for (uint32_t y = 0; y < 64; ++y)
        for (uint32_t x = 0; x < 64; ++x) hashes.insert(std::hash<TileId>()({6, x, y}));
    EXPECT_EQ(hashes.size(), 4096U);
}

TEST(HilbertId, GivesTheSpecificationsExamples) {
    EXPECT_EQ(hilbertId({0, 0, 0}), 0U);
    EXPECT_EQ(hilbertId({1, 0, 0}), 1U);
    EXPECT_EQ(hilbertId({1, 0, 1}), 2U);
    EXPECT_EQ(hilbertId({1, 1, 1}), 3U);
    EXPECT_EQ(hilbertId({1, 1, 0}), 4U);
    EXPECT_EQ(hilbertId({2, 0, 0}), 5U);
    EXPECT_EQ(hilbertId({12, 3423, 1763}), 19078479U);  // spec/v3/spec.md
}

TEST(HilbertId, RoundTripsAllTilesOfTheFirstLevels) {
    std::unordered_set<uint64_t> seen;
    for (uint32_t level = 0; level <= 6; ++level)
        for (uint32_t y = 0; y < 1U << level; ++y)
            for (uint32_t x = 0; x < 1U << level; ++x) {
                const TileId id{level, x, y};
                const uint64_t number = hilbertId(id);
                EXPECT_TRUE(seen.insert(number).second);
                EXPECT_EQ(*tileFromHilbert(number), id);
            }
    // Numbers are dense: none is left out.
    EXPECT_EQ(seen.size(), 5461U);
    EXPECT_TRUE(seen.contains(5460));
}

TEST(HilbertId, RoundTripsRandomTilesOfEveryLevel) {
    Random random(2);
    for (uint32_t level = 0; level <= kMaxTileLevel; ++level)
        for (int i = 0; i < 300; ++i) {
            const TileId id = randomTile(random, level);
            EXPECT_EQ(*tileFromHilbert(hilbertId(id)), id);
        }
}

TEST(HilbertId, ConsecutiveTilesTouch) {
    Random random(3);
    const auto expectTouching = [](uint64_t number) {
        const TileId a = *tileFromHilbert(number);
        const TileId b = *tileFromHilbert(number + 1);
        if (a.level != b.level) return;
        const auto step = std::abs(int64_t{a.x} - int64_t{b.x}) + std::abs(int64_t{a.y} - int64_t{b.y});
        EXPECT_EQ(step, 1) << a << " to " << b;
    };
    for (uint64_t number = 0; number < 5460; ++number) expectTouching(number);
    for (int i = 0; i < 2000; ++i)
        expectTouching(hilbertId(randomTile(random, 7 + static_cast<uint32_t>(random.below(24)))));
}

TEST(HilbertId, RefusesNumbersBeyondTheLastLevel) {
    const uint64_t last = 6148914691236517204U;  // (4^32 - 1) / 3 - 1
    EXPECT_EQ(tileFromHilbert(last)->level, kMaxTileLevel);
    EXPECT_EQ(hilbertId(*tileFromHilbert(last)), last);
    EXPECT_FALSE(tileFromHilbert(last + 1).ok());
    EXPECT_FALSE(tileFromHilbert(~uint64_t{0}).ok());
}

TEST(HilbertIdDeathTest, StopsOnAnIdThatCannotExist) {
    EXPECT_DEATH((void)hilbertId({1, 2, 0}), "valid");
}

TEST(Tiling, LaysTilesFromTheNorthWest) {
    const Tiling tiling{.west = 1000, .north = 5000, .finestSpacing = 0.5, .finestLevel = 3};
    EXPECT_EQ(tiling.spacing(3), 0.5);
    EXPECT_EQ(tiling.spacing(0), 4);
    EXPECT_EQ(tiling.spacing(5), 0.125);
    EXPECT_EQ(tiling.bounds({0, 0, 0}), (GroundRect{1000, 5000 - 2048, 1000 + 2048, 5000}));
    EXPECT_EQ(tiling.bounds({3, 7, 0}), (GroundRect{1000 + 7 * 256, 5000 - 256, 1000 + 2048, 5000}));
    EXPECT_EQ(Tiling::coreSamples({3, 7, 1}), (GridRect{3584, 512, 512, 512}));
}

TEST(Tiling, FindsTheLevelThatHoldsTheSamples) {
    EXPECT_EQ(Tiling::levelFor(1), 0U);
    EXPECT_EQ(Tiling::levelFor(512), 0U);
    EXPECT_EQ(Tiling::levelFor(513), 1U);
    EXPECT_EQ(Tiling::levelFor(1024), 1U);
    EXPECT_EQ(Tiling::levelFor(1025), 2U);
    EXPECT_EQ(Tiling::levelFor(1000000), 11U);
}

}  // namespace
}  // namespace terray
