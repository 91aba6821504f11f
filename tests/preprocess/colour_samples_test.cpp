#include "preprocess/colour_samples.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "common/imagery_tile.h"
#include "common/srgb.h"

namespace terray {
namespace {

/// The sRGB curve, written down a second time (IEC 61966-2-1).
double signalOf(double light) {
    return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
}

constexpr Rgba kNeutral = {kNeutralGround[0], kNeutralGround[1], kNeutralGround[2], 255};

TEST(Srgb, EveryValueReturnsToItself) {
    for (int value = 0; value < 256; ++value)
        EXPECT_EQ(srgbFromLinear(linearFromSrgb(static_cast<uint8_t>(value))), value);
}

TEST(Srgb, EncodesToTheNearestValue) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 200000; ++i) {
        // Squared, so that the dark end, where values lie densest, is looked at most.
        const double u = static_cast<double>(random() % (1u << 20)) / (1u << 20);
        const auto light = static_cast<float>(u * u);
        const double signal = 255 * signalOf(static_cast<double>(light));
        // The nearest, or either of two when the signal lies between them to the precision of a float.
        EXPECT_LE(std::abs(srgbFromLinear(light) - signal), 0.5 + 1e-4) << light;
    }
    EXPECT_EQ(srgbFromLinear(-1), 0);
    EXPECT_EQ(srgbFromLinear(std::nanf("")), 0);
    EXPECT_EQ(srgbFromLinear(7), 255);
}

TEST(ColourSamples, BlackAndWhiteMakeTheGreyOfHalfTheLight) {
    Grid<Rgba> checks({4, 4});
    for (int64_t y = 0; y < 4; ++y)
        for (int64_t x = 0; x < 4; ++x)
            checks.at(x, y) = (x + y) % 2 == 0 ? Rgba{0, 0, 0, 255} : Rgba{255, 255, 255, 255};
    ColourSamples half(GridSize{2, 2});
    halveColours(checks.view(), half);
    ColourSamples quarter(GridSize{1, 1});
    halveColours(half.views(), quarter);
    // 188 is the sRGB value of 50 % light; an average of values would give 128.
    EXPECT_EQ(shownColours(half.views()).at(1, 1), (Rgba{188, 188, 188, 255}));
    EXPECT_EQ(shownColours(quarter.views()).at(0, 0), (Rgba{188, 188, 188, 255}));
}

TEST(ColourSamples, UncoveredCellsHaveNoSay) {
    Grid<Rgba> cells({4, 2}, Rgba{9, 9, 9, 0});
    cells.at(0, 0) = {200, 100, 50, 255};
    ColourSamples half(GridSize{2, 1});
    halveColours(cells.view(), half);
    EXPECT_EQ(shownColours(half.views()).at(0, 0), (Rgba{200, 100, 50, 255}));
    EXPECT_EQ(shownColours(half.views()).at(1, 0), kNeutral);
    EXPECT_FLOAT_EQ(half.planes[3].at(0, 0), 0.25f);
    EXPECT_TRUE(anyPhoto(half.views()));
    EXPECT_FALSE(anyPhoto(half.views().window({1, 0, 1, 1})));
}

TEST(ColourSamples, CoverageWeighsThroughLevels) {
    // One white texel against four black ones: a fifth of the light, not a half.
    Grid<Rgba> cells({4, 4}, Rgba{});
    cells.at(0, 0) = {255, 255, 255, 255};
    for (const auto& [x, y] : {std::pair(2, 0), std::pair(3, 0), std::pair(2, 1), std::pair(3, 1)})
        cells.at(x, y) = {0, 0, 0, 255};
    ColourSamples half(GridSize{2, 2});
    halveColours(cells.view(), half);
    ColourSamples quarter(GridSize{1, 1});
    halveColours(half.views(), quarter);
    EXPECT_EQ(shownColours(quarter.views()).at(0, 0)[0], std::lround(255 * signalOf(0.2)));
}

TEST(ColourSamples, ShownPhotoIsAsItWasRead) {
    Grid<Rgba> cells({2, 1}, Rgba{1, 2, 3, 0});
    cells.at(1, 0) = {4, 5, 6, 255};
    const Grid<Rgba> shown = shownColours(cells.view());
    EXPECT_EQ(shown.at(0, 0), kNeutral);
    EXPECT_EQ(shown.at(1, 0), (Rgba{4, 5, 6, 255}));
}

}  // namespace
}  // namespace terray
