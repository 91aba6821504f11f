#include "common/reference/pixel_error.h"

#include <cmath>
#include <limits>
#include <set>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "common/reference/pixel_pattern.h"
#include "tests/reference/formula_heights.h"

namespace terray {
namespace {

using test::FormulaHeights;

constexpr Tiling kTiling{.west = 0, .north = 0, .finestSpacing = 10, .finestLevel = 0};

/// Flat ground at 20 m seen from the west, 30 degrees down, 101 x 81 pixels.
class PixelErrorTest : public testing::Test {
  protected:
    void SetUp() override {
        view_ = {.eye = {-300, -2000, 620},
                 .right = {0, -1, 0},
                 .up = {0.5, 0, std::sqrt(0.75)},
                 .forward = {std::sqrt(0.75), 0, -0.5},
                 .tanHalfHeight = 0.4,
                 .width = 101,
                 .height = 81};
    }
    [[nodiscard]] DrawnPixel drawnAt(const glm::ivec2& pixel, double height) const {
        const glm::dvec3 direction = view_.direction(pixel.x + 0.5, pixel.y + 0.5);
        const double depth = (height * view_.exaggeration - view_.eye.z) / direction.z;
        glm::dvec3 place = view_.eye + depth * direction;
        place.z /= view_.exaggeration;
        return {true, depth, place};
    }
    FormulaHeights heights_{{400, 400}, [](int64_t, int64_t) { return 20.0; }};
    GroundCaster truth_{heights_, kTiling, -100};
    View view_;
    const glm::ivec2 centre_{50, 40};
};

TEST_F(PixelErrorTest, WhatIsDrawnWhereItIsHasNone) {
    const PixelError error = pixelError(truth_, view_, centre_, drawnAt(centre_, 20));
    EXPECT_EQ(error.kind, PixelError::Kind::ground);
    EXPECT_NEAR(error.pixels, 0, 1e-6);
    EXPECT_NEAR(error.depthMetres, 0, 1e-6);
    EXPECT_NEAR(error.trueDepth, 1200, 1e-9);
}

TEST_F(PixelErrorTest, AHeightTooGreatIsItsProjection) {
    // 2 m too high: hit at depth 1196; 2 m of a vertical seen from 30 degrees above, to first order.
    const PixelError error = pixelError(truth_, view_, centre_, drawnAt(centre_, 22));
    EXPECT_NEAR(error.depthMetres, 4, 1e-6);
    EXPECT_NEAR(error.depthRelative, 4.0 / 1200, 1e-8);
    EXPECT_NEAR(error.pixels, 2 * std::sqrt(0.75) / 1196 * view_.focalPixels(), 2e-4);
}

TEST_F(PixelErrorTest, ExaggerationAndCurvatureProjectLikewise) {
    view_.exaggeration = 3;
    view_.eye.z = 660;
    const PixelError error = pixelError(truth_, view_, centre_, drawnAt(centre_, 22));
    EXPECT_NEAR(error.depthMetres, 12, 1e-6);
    EXPECT_NEAR(error.pixels, 6 * std::sqrt(0.75) / 1188 * view_.focalPixels(), 2e-3);
    // Over a curved earth the drawn point is where the bent ray is: on the ground again, so without error.
    view_.exaggeration = 1;
    view_.eye.z = 620;
    view_.earth = EarthCurvature{1e-5, 0, 1e-5};
    const glm::dvec3 direction = view_.direction(50.5, 40.5);
    const double depth = truth_.meet(view_, direction).value();
    EXPECT_GT(depth, 1210);
    EXPECT_NEAR(pixelError(truth_, view_, centre_, {true, depth, view_.at(direction, depth)}).pixels, 0, 1e-6);
}

TEST_F(PixelErrorTest, APointOnTheGroundsSideIsOnItsSurface) {
    view_.eye = {-100, -2000, 10};
    view_.forward = {1, 0, 0};
    view_.up = {0, 0, 1};
    const PixelError error = pixelError(truth_, view_, centre_, {true, 100.001, {0.001, -2000, 10}});
    EXPECT_NEAR(error.pixels, 0.001 / 100 * view_.focalPixels(), 1e-5);  // not the 10 m up to the ground's edge
}

TEST_F(PixelErrorTest, APointBeyondTheRimIsAsFarOffAsItsSideLooks) {
    // Level, from the west, 10 m below the edge: the side is drawn 4 m too near, in the axis and beside it.
    view_.eye = {-100, -2000, 10};
    view_.forward = {1, 0, 0};
    view_.up = {0, 0, 1};
    EXPECT_NEAR(pixelError(truth_, view_, centre_, {true, 96, {-4, -2000, 10}}).pixels, 0, 1e-5);
    const glm::ivec2 beside{90, 40};
    const glm::dvec3 direction = view_.direction(beside.x + 0.5, beside.y + 0.5);
    const glm::dvec3 place = view_.eye + 96.0 * direction;
    const double offAxis = direction.y * 96 * view_.focalPixels();  // pixels times metres of depth
    EXPECT_NEAR(pixelError(truth_, view_, beside, {true, 96, place}).pixels, std::abs(offAxis) * (1.0 / 96 - 1.0 / 100),
                1e-4);
}

TEST_F(PixelErrorTest, AHolesEdgeIsFoundLikewise) {
    // A hole of 200 m; 30 m from its western edge, and in the middle of it.
    const FormulaHeights holed({400, 400}, [](int64_t x, int64_t y) {
        return x >= 100 && x < 120 && y >= 100 && y < 120 ? std::numeric_limits<double>::quiet_NaN() : 20.0;
    });
    const GroundCaster truth(holed, kTiling, -100);
    EXPECT_FALSE(truth.heightAt(1030, -1100).has_value());
    const auto edge = truth.nearestEdge(1030, -1100);
    ASSERT_TRUE(edge.has_value());
    EXPECT_NEAR(edge->x, 1000, 1e-3);
    EXPECT_NEAR(edge->z, 20, 1e-9);
    EXPECT_NEAR(glm::length(*truth.nearestEdge(1100, -1100) - glm::dvec3(1100, -1100, 20)), 100, 2);
    EXPECT_FALSE(truth.nearestEdge(1e6, 0).has_value());
}

TEST_F(PixelErrorTest, HowDeepTheGroundsSideReachesIsNoError) {
    // From the west and below the surface: the side at x = 0 is met 40 m below its edge. Then the surface itself.
    view_.eye = {-100, -2000, -20};
    view_.forward = {1, 0, 0};
    view_.up = {0, 0, 1};
    EXPECT_EQ(pixelError(truth_, view_, centre_, {}).kind, PixelError::Kind::base);
    view_.exaggeration = 2;
    view_.eye.z *= 2;
    EXPECT_EQ(pixelError(truth_, view_, centre_, {}).kind, PixelError::Kind::base);
    view_.eye = {100, -2000, 41};
    EXPECT_EQ(pixelError(truth_, view_, {50, 41}, {}).kind, PixelError::Kind::seeThrough) << "sky within the surface";
}

TEST_F(PixelErrorTest, GroundAndSkyMayBeMistakenForEachOther) {
    view_.forward = {1, 0, 0};
    view_.up = {0, 0, 1};
    const glm::ivec2 sky{50, 0}, ground{50, 80};
    EXPECT_EQ(pixelError(truth_, view_, sky, {}).kind, PixelError::Kind::sky);
    EXPECT_EQ(pixelError(truth_, view_, sky, {true, 1, {0, 0, 0}}).kind, PixelError::Kind::coversSky);
    EXPECT_EQ(pixelError(truth_, view_, sky, {true, 1, {0, 0, -101}}).kind, PixelError::Kind::base);
    EXPECT_EQ(pixelError(truth_, view_, ground, {}).kind, PixelError::Kind::seeThrough);
    ErrorTotals totals;
    const std::vector<glm::ivec2> pixels{sky, sky, ground, ground};
    const std::vector<DrawnPixel> drawn{{}, {true, 1, {0, 0, 0}}, {}, drawnAt(ground, 20)};
    totals.add(pixelErrors(truth_, view_, pixels, drawn));
    EXPECT_EQ(totals.pixels, 4U);
    EXPECT_EQ(totals.coversSky, 1U);
    EXPECT_EQ(totals.seeThrough, 1U);
    EXPECT_EQ(totals.errorPixels.size(), 1U);
}

TEST_F(PixelErrorTest, ManyThreadsGiveWhatOneGives) {
    const std::vector<glm::ivec2> pixels = pixelPattern(101, 81, 3000);
    std::vector<DrawnPixel> drawn;
    for (const glm::ivec2& pixel : pixels) drawn.push_back(drawnAt(pixel, 20 + 0.01 * pixel.x));
    const std::vector<PixelError> errors = pixelErrors(truth_, view_, pixels, drawn);
    for (size_t n = 0; n < pixels.size(); ++n) EXPECT_EQ(errors[n], pixelError(truth_, view_, pixels[n], drawn[n]));
}

TEST(PixelPattern, TakesEachPixelAtMostOnceAndSpreadsThem) {
    const std::vector<glm::ivec2> pixels = pixelPattern(60, 40, 600);
    std::set<std::pair<int, int>> distinct;
    Grid<int> perBlock({6, 4});
    for (const glm::ivec2& pixel : pixels) {
        EXPECT_TRUE(distinct.emplace(pixel.x, pixel.y).second);
        ++perBlock.at(pixel.x / 10, pixel.y / 10);
    }
    EXPECT_EQ(distinct.size(), 600U);
    for (const int count : perBlock.cells()) EXPECT_NEAR(count, 25, 6);
    EXPECT_EQ(pixelPattern(60, 40, 10), std::vector(pixels.begin(), pixels.begin() + 10)) << "its beginning";
}

TEST(PixelPattern, TakesAllWhenThereAreNoMore) {
    EXPECT_EQ(pixelPattern(2, 2, 4), (std::vector<glm::ivec2>{{0, 0}, {1, 0}, {0, 1}, {1, 1}}));
    EXPECT_EQ(pixelPattern(1, 1, 100).size(), 1U);
}

}  // namespace
}  // namespace terray
