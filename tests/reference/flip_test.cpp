#include "common/reference/flip.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

namespace terray {
namespace {

constexpr GridSize kSize{48, 40};

template <class Colour>
Grid<Rgba> pictureOf(GridSize size, Colour colour) {
    Grid<Rgba> picture(size);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) picture.at(x, y) = colour(x, y);
    return picture;
}

Grid<Rgba> plain(uint8_t grey, GridSize size = kSize) {
    return Grid<Rgba>(size, {grey, grey, grey, 255});
}

Rgba patternAt(int x, int y) {
    return {static_cast<uint8_t>(x * 5 + (x / 8 % 2) * 90), static_cast<uint8_t>(y * 6),
            static_cast<uint8_t>((x * y) / 3), 255};
}

Grid<Rgba> pattern() {
    return pictureOf(kSize, patternAt);
}

/// The pattern one pixel to the left, with speckles and a corner of another hue.
Grid<Rgba> spoiltPattern() {
    return pictureOf(kSize, [](int x, int y) {
        Rgba colour = patternAt(x + 1, y);
        if ((x * 7 + y * 13) % 11 == 0) colour[1] = static_cast<uint8_t>(255 - colour[1]);
        if (x > 30 && y > 20) colour[2] = static_cast<uint8_t>(colour[2] / 2);
        return colour;
    });
}

double mean(const Grid<float>& errors) {
    return std::accumulate(errors.cells().begin(), errors.cells().end(), 0.0) / static_cast<double>(kSize.count());
}

/// FLIP of two plain pictures whose lightness (L* of CIELab) differs by this: there is nothing but colour, and none of
/// it is chroma. The farthest pair of colours, green and blue, by their published CIELab coordinates (D65).
double ofLightness(double difference) {
    const double greenL = 87.7347, greenA = -86.1827, greenB = 83.1793;
    const double blueL = 32.2970, blueA = 79.1875, blueB = -107.8602;
    const double farthest =
        greenL - blueL + std::hypot(0.01 * (greenL * greenA - blueL * blueA), 0.01 * (greenL * greenB - blueL * blueB));
    const double error = std::pow(difference / farthest, 0.7);  // of the greatest
    return error < 0.4 ? 0.95 * error / 0.4 : 0.95 + 0.05 * (error - 0.4) / 0.6;
}

TEST(Flip, EqualPicturesDoNotDiffer) {
    EXPECT_EQ(flipOf(pattern().view(), pattern().view()), Grid<float>(kSize, 0.0F));
}

TEST(Flip, AlphaDoesNotCount) {
    Grid<Rgba> other = pattern();
    for (Rgba& pixel : other.cells()) pixel[3] = 7;
    EXPECT_EQ(flipOf(pattern().view(), other.view()), Grid<float>(kSize, 0.0F));
}

TEST(Flip, BlackAgainstWhiteIsAsTheFormulaSays) {
    const Grid<float> errors = flipOf(plain(0).view(), plain(255).view());
    for (const float error : errors.cells()) EXPECT_NEAR(error, ofLightness(100), 1e-5);
    EXPECT_NEAR(ofLightness(100), 0.967, 0.001);
}

TEST(Flip, AStepOfGreyIsAsTheFormulaSays) {
    const auto lightness = [](double grey) {  // above 0.04045 of sRGB and 0.008856 of CIELab
        return 116 * std::cbrt(std::pow((grey / 255 + 0.055) / 1.055, 2.4)) - 16;
    };
    for (const int step : {1, 10, 60, 120}) {
        const auto lighter = static_cast<uint8_t>(100 + step);
        const double expected = ofLightness(lightness(lighter) - lightness(100));
        const Grid<float> errors = flipOf(plain(100).view(), plain(lighter).view());
        for (const float error : errors.cells()) ASSERT_NEAR(error, expected, 1e-4) << step;
    }
}

// Values of the authors' program, version 1.7, for the same two pictures.
TEST(Flip, AgreesWithItsAuthorsProgram) {
    struct Known {
        double pixelsPerDegree, mean, atOrigin, at10x7, at40x30, at47x39;
    };
    for (const Known& known : {Known{kFlipPixelsPerDegree, 0.4001215, 0.988988, 0.479766, 0.668387, 0.968941},
                               Known{30, 0.4097674, 0.993982, 0.483288, 0.584339, 0.983413},
                               Known{120, 0.3995763, 0.986173, 0.461288, 0.702460, 0.957497},
                               Known{5, 0.3696143, 0.999526, 0.353440, 0.614043, 0.992609}}) {
        const Grid<float> errors = flipOf(pattern().view(), spoiltPattern().view(), known.pixelsPerDegree);
        EXPECT_NEAR(mean(errors), known.mean, 1e-5) << known.pixelsPerDegree;
        EXPECT_NEAR(errors.at(0, 0), known.atOrigin, 1e-5) << known.pixelsPerDegree;
        EXPECT_NEAR(errors.at(10, 7), known.at10x7, 1e-5) << known.pixelsPerDegree;
        EXPECT_NEAR(errors.at(40, 30), known.at40x30, 1e-5) << known.pixelsPerDegree;
        EXPECT_NEAR(errors.at(47, 39), known.at47x39, 1e-5) << known.pixelsPerDegree;
    }
}

TEST(Flip, ExchangingThePicturesChangesNothing) {
    EXPECT_EQ(flipOf(pattern().view(), spoiltPattern().view()), flipOf(spoiltPattern().view(), pattern().view()));
}

TEST(Flip, MirroredPicturesHaveAMirroredMap) {
    const auto mirrored = [](const Grid<Rgba>& picture) {
        return pictureOf(kSize, [&](int x, int y) { return picture.at(kSize.width - 1 - x, y); });
    };
    const Grid<float> errors = flipOf(pattern().view(), spoiltPattern().view());
    const Grid<float> ofMirrored = flipOf(mirrored(pattern()).view(), mirrored(spoiltPattern()).view());
    for (int y = 0; y < kSize.height; ++y)
        for (int x = 0; x < kSize.width; ++x)
            ASSERT_NEAR(errors.at(x, y), ofMirrored.at(kSize.width - 1 - x, y), 1e-4) << x << ", " << y;
}

TEST(Flip, WhatIsTooFineForTheEyeFadesWithItsDistance) {
    const Grid<Rgba> chequered = pictureOf(kSize, [](int x, int y) {
        const auto grey = static_cast<uint8_t>((x + y) % 2 == 0 ? 255 : 0);
        return Rgba{grey, grey, grey, 255};
    });
    const Grid<Rgba> sameLight = plain(188);  // half of white's light
    const double near = mean(flipOf(chequered.view(), sameLight.view(), 10));
    const double far = mean(flipOf(chequered.view(), sameLight.view(), 200));
    EXPECT_GT(near, 0.5);
    EXPECT_LT(far, 0.1);
}

TEST(Flip, TakesPicturesOfOnePixelRowOrColumn) {
    for (const GridSize size : {GridSize{1, 1}, GridSize{9, 1}, GridSize{1, 9}}) {
        const Grid<float> errors = flipOf(plain(0, size).view(), plain(255, size).view());
        for (const float error : errors.cells()) EXPECT_NEAR(error, ofLightness(100), 1e-5);
    }
}

}  // namespace
}  // namespace terray
