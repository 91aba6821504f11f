#include "common/grid.h"

#include <numeric>

#include <gtest/gtest.h>

namespace terray {
namespace {

/// Cells numbered row by row: cell (x, y) holds 10 y + x.
Grid<int> numbered() {
    Grid<int> grid({10, 6});
    std::iota(grid.cells().begin(), grid.cells().end(), 0);
    return grid;
}

TEST(Grid, IsRowMajor) {
    const Grid<int> grid = numbered();
    EXPECT_EQ(grid.at(0, 0), 0);
    EXPECT_EQ(grid.at(9, 0), 9);
    EXPECT_EQ(grid.at(0, 5), 50);
    EXPECT_EQ(grid.at(9, 5), 59);
    EXPECT_EQ(grid.size().count(), 60);
}

TEST(GridView, WindowsShareTheCells) {
    Grid<int> grid = numbered();
    const GridView<int> window = grid.view().window({3, 2, 4, 3});
    EXPECT_EQ(window.size(), (GridSize{4, 3}));
    EXPECT_EQ(window.stride(), 10);
    for (int64_t y = 0; y < 3; ++y)
        for (int64_t x = 0; x < 4; ++x) EXPECT_EQ(window.at(x, y), 10 * (y + 2) + x + 3);
    window.at(3, 2) = -1;
    EXPECT_EQ(grid.at(6, 4), -1);

    const GridView<int> inner = window.window({1, 1, 2, 2});
    EXPECT_EQ(inner.at(0, 0), 34);
    EXPECT_EQ(inner.row(1).size(), 2U);
    EXPECT_EQ(inner.row(1)[0], 44);
}

TEST(GridView, WindowsMayTouchEveryBorderAndBeEmpty) {
    Grid<int> grid = numbered();
    EXPECT_EQ(grid.view().window({0, 0, 10, 6}).at(9, 5), 59);
    EXPECT_EQ(grid.view().window({9, 5, 1, 1}).at(0, 0), 59);
    EXPECT_EQ(grid.view().window({10, 6, 0, 0}).size().count(), 0);
}

TEST(GridView, ClampsToItsOwnBorder) {
    Grid<int> grid = numbered();
    const GridView<const int> window = GridView<const int>(grid.view()).window({3, 2, 4, 3});
    EXPECT_EQ(window.clamped(-5, -5), 23);
    EXPECT_EQ(window.clamped(4, 1), 36);
    EXPECT_EQ(window.clamped(100, 100), 46);
    EXPECT_EQ(window.clamped(1, 1), window.at(1, 1));
}

TEST(GridViewDeathTest, StopsOnAccessOutside) {
    Grid<int> grid = numbered();
    const GridView<int> view = grid.view();
    EXPECT_DEATH((void)view.at(10, 0), "cell 10, 0 of 10 x 6");
    EXPECT_DEATH((void)view.at(0, -1), "cell 0, -1");
    EXPECT_DEATH((void)view.row(6), "cell 0, 6");
    EXPECT_DEATH((void)view.window({7, 0, 4, 1}), "size_.width");
    EXPECT_DEATH((void)view.window({0, -1, 4, 1}), "rect.y");
}

TEST(GridRect, IntersectsToWhatBothCover) {
    EXPECT_EQ(intersection({0, 0, 5, 5}, {3, 4, 5, 5}), (GridRect{3, 4, 2, 1}));
    EXPECT_EQ(intersection({-3, -3, 4, 4}, {0, 0, 9, 9}), (GridRect{0, 0, 1, 1}));
    EXPECT_TRUE(intersection({0, 0, 5, 5}, {5, 0, 5, 5}).empty());
    EXPECT_TRUE(intersection({0, 0, 5, 5}, {0, 9, 5, 5}).empty());
}

}  // namespace
}  // namespace terray
