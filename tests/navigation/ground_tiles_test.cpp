#include "client/navigation/ground_tiles.h"

#include <gtest/gtest.h>

#include "common/error.h"
#include "tests/common/random.h"
#include "tests/support/analytic_dataset.h"

namespace terray::test {
namespace {

/// What is known in the end.
std::optional<GroundHeight> settled(GroundTiles& ground, glm::dvec2 place) {
    (void)ground.under(place);
    ground.waitUntilSettled();
    return ground.under(place);
}

glm::dvec2 placeIn(const GroundRect& ground, Random& random) {
    return {random.between(ground.west, ground.east - 1e-6), random.between(ground.south + 1e-6, ground.north)};
}

TEST(GroundTiles, BoundTheGroundAtOnceAndKnowItInTheEnd) {
    const AnalyticDataset dataset({.finestLevel = 2, .spacing = 4});
    GroundTiles tiles(dataset, {});
    Random random(1);
    for (int n = 0; n < 60; ++n) {
        const glm::dvec2 place = placeIn(dataset.metadata().groundBounds(), random);
        const double truth = AnalyticDataset::heightAt(place.x, place.y);
        const auto first = tiles.under(place);
        ASSERT_TRUE(first.has_value());
        // Of a bilinear surface over cells: a metre more for the slope within a finest cell.
        EXPECT_GE(first->height + first->uncertainty, truth - 4 * AnalyticDataset::kSteepest);
        const auto last = settled(tiles, place);
        ASSERT_TRUE(last.has_value());
        EXPECT_EQ(last->uncertainty, 0);
        EXPECT_NEAR(last->height, truth, 0.1) << "bilinear over 4 m";
    }
}

TEST(GroundTiles, ColumnsAreLevelOverTheirCells) {
    const AnalyticDataset dataset({.finestLevel = 1, .spacing = 4});
    GroundTiles tiles(dataset, {});
    tiles.setColumns(true);
    const GroundRect ground = dataset.metadata().groundBounds();
    const glm::dvec2 corner(ground.west + 400, ground.north - 400);
    const auto a = settled(tiles, corner + glm::dvec2(0.1, -0.1)), b = settled(tiles, corner + glm::dvec2(3.9, -3.9));
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->height, b->height);
    EXPECT_NEAR(a->height, AnalyticDataset::heightAt(corner.x + 2, corner.y - 2), dataset.metadata().quantum);
}

TEST(GroundTiles, EndAtTheDatasetsEdge) {
    const AnalyticDataset dataset({.finestLevel = 1, .spacing = 4});
    GroundTiles tiles(dataset, {});
    const GroundRect ground = dataset.metadata().groundBounds();
    EXPECT_TRUE(tiles.under({ground.west, ground.north}).has_value());
    EXPECT_FALSE(tiles.under({ground.west - 1, ground.north}).has_value());
    EXPECT_FALSE(tiles.under({ground.east, ground.north}).has_value());
    EXPECT_FALSE(tiles.under({0, 1e30}).has_value());
}

TEST(GroundTiles, StandOnEditedGround) {
    const AnalyticDataset dataset({.finestLevel = 1, .spacing = 4});
    const GroundRect ground = dataset.metadata().groundBounds();
    const glm::dvec2 place(ground.west + 1000, ground.north - 1000);
    GroundTiles tiles(dataset, {.edits = {{.line = {{place, place}}, .radius = 200, .full = 100, .height = 300}}});
    const auto raised = settled(tiles, place);
    ASSERT_TRUE(raised.has_value());
    EXPECT_NEAR(raised->height, AnalyticDataset::heightAt(place.x, place.y) + 300, 0.1);
}

TEST(GroundTiles, ATileThatCannotBeReadLeavesTheBoundOfTheOneAbove) {
    AnalyticDataset dataset({.finestLevel = 1, .spacing = 4});
    dataset.lose(TileLayer::heights, TileId{}.child(0));
    GroundTiles tiles(dataset, {});
    const GroundRect ground = dataset.metadata().groundBounds();
    const auto height = settled(tiles, {ground.west + 100, ground.north - 100});
    ASSERT_TRUE(height.has_value());
    EXPECT_GT(height->uncertainty, 0);
    EXPECT_FALSE(tiles.learning()) << "it is not asked for again and again";
    dataset.lose(TileLayer::heights, {});
    EXPECT_THROW(GroundTiles(dataset, {}), Error);
}

TEST(GroundTiles, HoldNoMoreThanTheyMay) {
    const AnalyticDataset dataset({.finestLevel = 2, .spacing = 4});
    GroundTiles tiles(dataset, {.mostTiles = 6});
    Random random(2);
    for (int n = 0; n < 200; ++n) {
        const auto height = settled(tiles, placeIn(dataset.metadata().groundBounds(), random));
        ASSERT_TRUE(height.has_value());
        EXPECT_EQ(height->uncertainty, 0);
    }
    EXPECT_GT(dataset.reads(), 50u) << "of 21 tiles: what was let go is read again";
}

TEST(GroundTiles, OfACoarserLevelAreReadNoFurther) {
    const AnalyticDataset dataset({.finestLevel = 2, .spacing = 4});
    GroundTiles tiles(dataset, {.finestLevel = 1});
    const GroundRect ground = dataset.metadata().groundBounds();
    const auto height = settled(tiles, {ground.west + 700, ground.north - 700});
    ASSERT_TRUE(height.has_value());
    EXPECT_GT(height->uncertainty, 0) << "the finest may be higher";
    EXPECT_EQ(dataset.reads(), 2u);
}

}  // namespace
}  // namespace terray::test
