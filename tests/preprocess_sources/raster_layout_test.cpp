// Choice of grids and levels, without any raster library.

#include "preprocess/raster_layout.h"

#include <gtest/gtest.h>

namespace terray {
namespace {

TEST(RasterLayout, TakesSquareNorthUpGridsAsTheyAre) {
    const std::optional<SquareGrid> grid = squareGrid({100, 2, 0, 50, 0, -2}, {10, 5});
    ASSERT_TRUE(grid);
    EXPECT_EQ(grid->bounds(), (GroundRect{100, 40, 120, 50}));
    EXPECT_TRUE(squareGrid({100, 2, 0, 50, 0, -2.000001}, {10, 5}));
    EXPECT_FALSE(squareGrid({100, 2, 0, 50, 0, -2.00001}, {10, 5}));
    EXPECT_FALSE(squareGrid({100, 2, 0, 50, 0, 2}, {10, 5}));
    EXPECT_FALSE(squareGrid({100, 2, 0.1, 50, 0, -2}, {10, 5}));
}

TEST(RasterLayout, KnowsWhichGridsMatch) {
    const GeoTransform grid{100, 2, 0, 50, 0, -2};
    EXPECT_TRUE(shareGrid(grid, {-7000.01, 2, 0, 1050, 0, -2}));
    EXPECT_FALSE(shareGrid(grid, {101, 2, 0, 50, 0, -2}));
    EXPECT_FALSE(shareGrid(grid, {100, 4, 0, 50, 0, -4}));
}

TEST(RasterLayout, CoversAnExtentWithoutASliver) {
    const SquareGrid free = coveringGrid({0.5, 0, 10.5, 10}, 2.5, nullptr);
    EXPECT_EQ(free.west, 0.5);
    EXPECT_EQ(free.size, (GridSize{4, 4}));
    EXPECT_EQ(coveringGrid({0, 0, 10.0000001, 10}, 2.5, nullptr).size, (GridSize{4, 4}));
    EXPECT_EQ(coveringGrid({0, 0, 10.1, 10}, 2.5, nullptr).size, (GridSize{5, 4}));
}

// A count beyond 64 bits once became a grid of one cell.
TEST(RasterLayout, KeepsAnAbsurdSpacingAbsurd) {
    const GridSize size = coveringGrid({0, 0, 1e5, 1e5}, 1e-20, nullptr).size;
    EXPECT_GT(size.width, int64_t{1} << 40);
    EXPECT_GT(size.height, int64_t{1} << 40);
}

TEST(RasterLayout, AlignsToAnAnchor) {
    const SquareGrid anchor{.west = 100, .north = 200, .spacing = 10, .size = {5, 5}};
    const SquareGrid grid = coveringGrid({83, 101, 155, 212}, 10, &anchor);
    EXPECT_EQ(grid.west, 80);
    EXPECT_EQ(grid.north, 220);
    EXPECT_EQ(grid.size, (GridSize{8, 12}));
}

TEST(RasterLayout, FindsWhatTwoExtentsShare) {
    EXPECT_EQ(overlapOf({0, 0, 10, 10}, {5, -5, 20, 5}), (GroundRect{5, 0, 10, 5}));
    EXPECT_FALSE(overlapOf({0, 0, 10, 10}, {10, 0, 20, 10}));
    EXPECT_EQ(unionOf({0, 0, 10, 10}, {5, -5, 20, 5}), (GroundRect{0, -5, 20, 10}));
}

TEST(RasterLayout, ChoosesTheCoarsestImageryLevelWithinTheTolerance) {
    const Tiling tiling{.finestSpacing = 1, .finestLevel = 3};
    EXPECT_EQ(imageryLevelFor(1, tiling), 3u);
    EXPECT_EQ(imageryLevelFor(0.84, tiling), 3u);  // 1 <= 1.2 * 0.84
    EXPECT_EQ(imageryLevelFor(0.83, tiling), 4u);
    EXPECT_EQ(imageryLevelFor(0.125, tiling), 6u);
    EXPECT_EQ(imageryLevelFor(4, tiling), 1u);
    EXPECT_EQ(imageryLevelFor(1000, tiling), 0u);
    EXPECT_EQ(imageryLevelFor(1e-30, tiling), kMaxTileLevel);
}

TEST(RasterLayout, CountsImageryCellsFromTheRootsCorner) {
    const Tiling tiling{.west = 100, .north = 200, .finestSpacing = 2, .finestLevel = 1};
    EXPECT_EQ(imageryCells({100, 190, 110, 200}, tiling, 1), (GridRect{0, 0, 5, 5}));
    EXPECT_EQ(imageryCells({101, 189, 111, 199}, tiling, 1), (GridRect{0, 0, 6, 6}));
    EXPECT_EQ(imageryCells({101, 189, 111, 199}, tiling, 2), (GridRect{1, 1, 10, 10}));
}

TEST(RasterLayout, KnowsUnitsOfHeight) {
    EXPECT_EQ(metresPerHeightUnit("m"), 1);
    EXPECT_EQ(metresPerHeightUnit("Feet"), 0.3048);
    EXPECT_EQ(metresPerHeightUnit("US survey foot"), 1200.0 / 3937);
    EXPECT_EQ(metresPerHeightUnit("km"), 1000);
    EXPECT_FALSE(metresPerHeightUnit(""));
    EXPECT_FALSE(metresPerHeightUnit("dB"));
}

TEST(RasterLayout, DescribesExtentsForPeople) {
    EXPECT_EQ(describe({557805, 5107995, 567615, 5122035}, "EPSG:26710"),
              "W 557805, S 5107995, E 567615, N 5122035 (metres, EPSG:26710)");
    EXPECT_EQ(describe({0, -1.5, 1, 0}, ""), "W 0, S -1.5, E 1, N 0 (metres, unnamed plane)");
}

}  // namespace
}  // namespace terray
