// The procedural terrain: the same everywhere, whatever window is read.

#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "common/checksum.h"
#include "preprocess/raster_files.h"

namespace terray {
namespace {

constexpr SyntheticTerrain kTerrain{.size = 2000, .spacing = 5, .seed = 42};

Grid<float> heightsOf(const SyntheticTerrain& terrain, const GridRect& window) {
    Grid<float> heights({window.width, window.height});
    makeSyntheticHeights(terrain)->openReader()->read(window, heights.view());
    return heights;
}

Grid<Rgba> photoOf(const SyntheticTerrain& terrain, const GridRect& window) {
    const Tiling tiling{.finestSpacing = terrain.spacing, .finestLevel = Tiling::levelFor(terrain.size)};
    Grid<Rgba> texels({window.width, window.height});
    makeSyntheticPhoto(terrain, tiling)->openReader()->read(window, texels.view());
    return texels;
}

TEST(Synthetic, IsTheSameOnEveryMachine) {
    // Any change here changes the datasets of tests and benchmarks: then say so, and renew the numbers.
    const Grid<float> heights = heightsOf(kTerrain, {700, 900, 257, 131});
    EXPECT_EQ(crc32c(std::as_bytes(heights.cells())), 1901152856u);
    const Grid<Rgba> photo = photoOf(kTerrain, {1400, 1800, 257, 131});
    EXPECT_EQ(crc32c(std::as_bytes(photo.cells())), 925748968u);
}

TEST(Synthetic, DoesNotDependOnTheWindow) {
    const Grid<float> wide = heightsOf(kTerrain, {100, 50, 400, 300});
    const Grid<float> narrow = heightsOf(kTerrain, {313, 177, 61, 45});
    for (int64_t y = 0; y < narrow.height(); ++y)
        for (int64_t x = 0; x < narrow.width(); ++x)
            ASSERT_EQ(narrow.at(x, y), wide.at(x + 213, y + 127)) << x << ", " << y;
    const Grid<Rgba> widePhoto = photoOf(kTerrain, {100, 50, 400, 300});
    const Grid<Rgba> narrowPhoto = photoOf(kTerrain, {313, 177, 61, 45});
    for (int64_t y = 0; y < narrow.height(); ++y)
        for (int64_t x = 0; x < narrow.width(); ++x)
            ASSERT_EQ(narrowPhoto.at(x, y), widePhoto.at(x + 213, y + 127)) << x << ", " << y;
}

TEST(Synthetic, EndsAtItsBorders) {
    const Grid<float> heights = heightsOf(kTerrain, {-2, 1990, 12, 12});
    const Grid<Rgba> photo = photoOf(kTerrain, {3990, -2, 12, 12});
    for (int64_t y = 0; y < 12; ++y)
        for (int64_t x = 0; x < 12; ++x) {
            EXPECT_EQ(std::isnan(heights.at(x, y)), x < 2 || y >= 10) << x << ", " << y;
            EXPECT_EQ(photo.at(x, y)[3], x >= 10 || y < 2 ? 0 : 255) << x << ", " << y;
        }
}

TEST(Synthetic, HasPeaksPlainsAndAFlatLake) {
    const Grid<float> heights = heightsOf(kTerrain, {0, 0, kTerrain.size, kTerrain.size});
    const auto [low, high] = std::ranges::minmax(heights.cells());
    EXPECT_GE(low, 0);
    EXPECT_GT(high, 900);  // 10 km wide: 1500 m of relief
    EXPECT_LT(high, 2000);
    const auto flat =
        static_cast<double>(std::ranges::count(heights.cells(), low)) / static_cast<double>(heights.size().count());
    EXPECT_GT(flat, 0.005);
    EXPECT_LT(flat, 0.4);
}

TEST(Synthetic, KeepsItsReliefInProportionToItsExtent) {
    const Grid<float> heights = heightsOf({.size = 256, .spacing = 1, .seed = 3}, {0, 0, 256, 256});
    const auto [low, high] = std::ranges::minmax(heights.cells());
    EXPECT_GT(high - low, 5);
    EXPECT_LT(high, 80);
}

TEST(Synthetic, DiffersBySeed) {
    const GridRect window{0, 0, 64, 64};
    EXPECT_NE(heightsOf(kTerrain, window), heightsOf({.size = 2000, .spacing = 5, .seed = 43}, window));
}

TEST(Synthetic, WorksAtExtremeSizes) {
    EXPECT_FALSE(std::isnan(heightsOf({.size = 1, .spacing = 0.01, .seed = 0}, {0, 0, 1, 1}).at(0, 0)));
    const int64_t size = int64_t{1} << 30;  // a billion samples along a side: only the window costs
    const Grid<float> corner = heightsOf({.size = size, .spacing = 1, .seed = 1}, {size - 8, size - 8, 8, 8});
    for (const float height : corner.cells()) EXPECT_TRUE(std::isfinite(height));
}

TEST(Synthetic, PaintsOneLevelFinerThanTheHeights) {
    const Tiling tiling{.west = 0, .north = 0, .finestSpacing = 5, .finestLevel = Tiling::levelFor(kTerrain.size)};
    const auto photo = makeSyntheticPhoto(kTerrain, tiling);
    EXPECT_EQ(photo->level(), tiling.finestLevel + 1);
    EXPECT_EQ(photo->bounds(), (GroundRect{0, -10000, 10000, 0}));
    std::map<Rgba, int> colours;
    const Grid<Rgba> texels = photoOf(kTerrain, {0, 0, 512, 512});
    for (const Rgba& texel : texels.cells()) ++colours[texel];
    EXPECT_GT(colours.size(), 200u);
}

}  // namespace
}  // namespace terray
