#include "preprocess/filled_heights.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/preprocess/test_dataset.h"

namespace terray {
namespace {

/// An inclined plane, with holes where `isHole` says so.
std::unique_ptr<HeightSource> plane(GridSize size, const std::function<bool(int64_t x, int64_t y)>& isHole) {
    return std::make_unique<GridHeights>(makeHeights(size, [&](int64_t x, int64_t y) {
        return isHole(x, y) ? std::nan("") : 100 + 0.5 * static_cast<double>(x) + 0.25 * static_cast<double>(y);
    }));
}

Grid<float> readWindow(const HeightSource& source, const GridRect& window) {
    Grid<float> heights({window.width, window.height});
    source.openReader()->read(window, heights.view());
    return heights;
}

TEST(FillNodata, LaysHolesAtSeaLevelButNotWhatLiesBeyondTheGrid) {
    const auto source = fillNodata(plane({40, 30}, [](int64_t x, int64_t) { return x > 20; }), NodataPolicy::sea);
    const Grid<float> heights = readWindow(*source, {-5, -5, 50, 40});
    EXPECT_TRUE(std::isnan(heights.at(4, 10)));
    EXPECT_TRUE(std::isnan(heights.at(45, 10)));
    EXPECT_TRUE(std::isnan(heights.at(10, 35)));
    EXPECT_EQ(heights.at(5, 5), 100);
    EXPECT_EQ(heights.at(26, 5), 0);
    EXPECT_EQ(heights.at(44, 34), 0);
}

TEST(FillNodata, LeavesHolesUnlessAskedTo) {
    const auto source = fillNodata(plane({40, 30}, [](int64_t x, int64_t) { return x > 20; }), NodataPolicy::holes);
    EXPECT_TRUE(std::isnan(readWindow(*source, {0, 0, 40, 30}).at(25, 5)));
}

#if TERRAY_WITH_GDAL
TEST(FillNodata, InterpolatesWhatIsNearAndLeavesWhatIsFar) {
    const auto source = fillNodata(plane({700, 600},
                                         [](int64_t x, int64_t y) {
                                             const bool isPit = x > 100 && x < 109 && y > 100 && y < 109;
                                             return isPit || x > 400;
                                         }),
                                   NodataPolicy::interpolate);
    const Grid<float> heights = readWindow(*source, {-3, -3, 706, 606});
    // Between samples up to 9 apart the plane rises 9 * 0.75 m; inverse distances stay within that.
    EXPECT_NEAR(heights.at(104 + 3, 104 + 3), 100 + 0.5 * 104 + 0.25 * 104, 7);
    EXPECT_EQ(heights.at(99 + 3, 104 + 3), 100 + 0.5f * 99 + 0.25f * 104);
    EXPECT_FALSE(std::isnan(heights.at(403 + 3, 300)));
    EXPECT_TRUE(std::isnan(heights.at(400 + kFillDistance + 2 + 3, 300)));
    EXPECT_TRUE(std::isnan(heights.at(1, 300)));
}

TEST(FillNodata, EveryWindowHoldsTheSameHeights) {
    Grid<float> hills = makeHills({900, 800}, 4, 300);
    for (int64_t y = 200; y < 500; ++y)
        for (int64_t x = 100; x < 460; ++x) hills.at(x, y) = kNoHeight;
    const auto source = fillNodata(std::make_unique<GridHeights>(std::move(hills)), NodataPolicy::interpolate);
    const Grid<float> whole = readWindow(*source, {0, 0, 900, 800});
    int64_t filled = 0;
    for (const GridRect window : {GridRect{0, 0, 300, 300}, GridRect{93, 187, 200, 320}, GridRect{250, 250, 650, 550},
                                  GridRect{-4, 390, 520, 130}}) {
        const Grid<float> part = readWindow(*source, window);
        for (int64_t y = std::max<int64_t>(0, -window.y); y < window.height; ++y)
            for (int64_t x = std::max<int64_t>(0, -window.x); x < window.width; ++x) {
                const float expected = whole.at(window.x + x, window.y + y);
                ASSERT_EQ(std::isnan(part.at(x, y)), std::isnan(expected)) << x << ", " << y;
                if (std::isnan(expected)) continue;
                ASSERT_EQ(part.at(x, y), expected) << x << ", " << y;
                ++filled;
            }
    }
    EXPECT_GT(filled, 300000);
}

TEST(FillNodata, ADatasetDoesNotDependOnHowItIsDivided) {
    const TemporaryDirectory directory;
    const auto source =
        fillNodata(std::make_unique<GridHeights>(makeHills({1500, 700}, 4, 400)), NodataPolicy::interpolate);
    const BuildSummary summary = buildTestDataset(*source, directory / "a", {.jobs = 2, .depth = 2});
    EXPECT_EQ(summary.metadata.holeSamples, 0u);
    (void)buildTestDataset(*source, directory / "b", {.jobs = 1, .depth = 1});
    EXPECT_EQ(readFile(directory / "a" / kHeightsFile), readFile(directory / "b" / kHeightsFile));
}
#endif

}  // namespace
}  // namespace terray
