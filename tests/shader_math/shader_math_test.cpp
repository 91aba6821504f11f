// The modules of shaders/math against closed forms, in float and in double from the same source.

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "shaders/math/math.h"

namespace {

namespace f = terray::mathf;
namespace d = terray::mathd;

TEST(SafeInverse, IsFiniteAndKeepsTheSign) {
    for (const float value : {0.0f, -0.0f, 1e-45f, -1e-45f, 1e-31f, -1e-31f}) {
        EXPECT_TRUE(std::isfinite(f::safeInverse(value))) << value;
        EXPECT_EQ(std::abs(f::safeInverse(value)), 1.0f / 1e-30f) << value;
    }
    EXPECT_EQ(f::safeInverse(-4.0f), -0.25f);
    EXPECT_EQ(d::safeInverse(4.0), 0.25);
}

TEST(BoxInterval, MatchesClosedFormsFromOutsideInsideAndAlongAxes) {
    const d::vec3 low(0, 0, 0);
    const d::vec3 high(4, 2, 1);
    const auto interval = [&](d::vec3 eye, d::vec3 dir) {
        return d::boxInterval(eye, {d::safeInverse(dir.x), d::safeInverse(dir.y), d::safeInverse(dir.z)}, low, high);
    };
    EXPECT_DOUBLE_EQ(interval({-2, 1, 0.5}, {1, 0, 0}).enter, 2);
    EXPECT_DOUBLE_EQ(interval({-2, 1, 0.5}, {1, 0, 0}).exit, 6);
    EXPECT_DOUBLE_EQ(interval({1, 1, 0.5}, {0, 0, -1}).enter, 0);  // inside: starts at the eye
    EXPECT_DOUBLE_EQ(interval({1, 1, 0.5}, {0, 0, -1}).exit, 0.5);
    EXPECT_DOUBLE_EQ(interval({1, 1, 5}, {0, 0, -2}).enter, 2);  // vertical
    const auto beside = interval({1, 3, 0.5}, {1, 0, 0});        // parallel to a face, outside it
    EXPECT_LT(beside.exit, beside.enter);
    const auto behind = interval({6, 1, 0.5}, {1, 0, 0});  // box behind the eye
    EXPECT_LT(behind.exit, behind.enter);
}

TEST(BoxInterval, FloatAgreesWithDoubleToAFewLastPlaces) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> place(-2000, 2000);
    std::uniform_real_distribution<float> component(-1, 1);
    int met = 0;
    for (int i = 0; i < 20000; ++i) {
        const f::vec3 eye(place(random), place(random), place(random));
        const f::vec3 dir(component(random), component(random), component(random));
        const f::vec3 low(0, 0, 0);
        const f::vec3 high(512, 512, 1000);
        const f::vec3 inverse(f::safeInverse(dir.x), f::safeInverse(dir.y), f::safeInverse(dir.z));
        const auto single = f::boxInterval(eye, inverse, low, high);
        const d::vec3 exact(d::safeInverse(dir.x), d::safeInverse(dir.y), d::safeInverse(dir.z));
        const auto twice = d::boxInterval(d::vec3(eye), exact, d::vec3(low), d::vec3(high));
        if (twice.exit < twice.enter) continue;
        ++met;
        // One subtraction, one reciprocal, one product: three roundings of 2^-24 each.
        const double bound = 4 * std::ldexp(1.0, -24);
        EXPECT_NEAR(single.enter, twice.enter, bound * (1 + std::abs(twice.enter)));
        EXPECT_NEAR(single.exit, twice.exit, bound * (1 + std::abs(twice.exit)));
    }
    EXPECT_GT(met, 300);
}

/// Cells of a mirrored ray by the walk of cell_walk.glsl at one level, checked against the cells that dense points lie
/// in.
template <class Walk>
void expectCellsInOrder(double slopeX, double slopeY) {
    const d::vec2 eye(0.3, 0.7);
    const d::vec2 dir(slopeX, slopeY);
    const d::vec2 inverse(d::safeInverse(dir.x), d::safeInverse(dir.y));
    d::ivec2 cell(0, 0);
    double t = 0;
    while (cell.x < 40 && cell.y < 40) {
        const d::ivec2 edge = d::blockEdge(cell, 0);
        const d::vec2 times = d::edgeTimes(edge, eye, inverse);
        const double leave = std::min(times.x, times.y);
        ASSERT_GE(leave, t);
        const double middle = 0.5 * (t + leave);
        if (leave - t > 1e-9) {
            EXPECT_EQ(cell.x, static_cast<int>(std::floor(eye.x + middle * dir.x)));
            EXPECT_EQ(cell.y, static_cast<int>(std::floor(eye.y + middle * dir.y)));
        }
        const d::ivec2 next = d::cellAfter(cell, edge, times, eye, dir);
        ASSERT_EQ((next.x - cell.x) + (next.y - cell.y), 1) << "one edge at a time";
        cell = next;
        t = leave;
    }
}

TEST(CellWalk, VisitsEveryCellOfTheRayInOrder) {
    for (const auto& [x, y] :
         {std::pair{1.0, 0.37}, {0.37, 1.0}, {1.0, 1.0}, {1.0, 0.0}, {0.0, 1.0}, {1.0, 1e-9}, {0.2, 3.0}})
        expectCellsInOrder<d::vec2>(x, y);
}

TEST(CellWalk, ProgressesThroughEveryCornerOfADiagonal) {
    // Through all corners: both edges at equal t. x is crossed first, then y; no cell is visited twice.
    const f::vec2 eye(0, 0);
    const f::vec2 dir(0.1f, 0.1f);
    const f::vec2 inverse(f::safeInverse(dir.x), f::safeInverse(dir.y));
    f::ivec2 cell(0, 0);
    int steps = 0;
    while (cell.x < 512 && cell.y < 512) {
        const f::ivec2 edge = f::blockEdge(cell, 0);
        const f::ivec2 next = f::cellAfter(cell, edge, f::edgeTimes(edge, eye, inverse), eye, dir);
        ASSERT_EQ((next.x - cell.x) + (next.y - cell.y), 1);
        cell = next;
        ++steps;
    }
    EXPECT_LE(steps, 1024);
}

TEST(CellWalk, ClimbsOnlyWhenATwoByTwoGroupIsLeft) {
    const d::vec2 throughX(1, 2);
    EXPECT_EQ(d::levelAfter(3, 8, d::ivec2(8, 8), throughX), 3);      // edge 8 >> 3 = 1: odd, within the group
    EXPECT_EQ(d::levelAfter(3, 8, d::ivec2(16, 8), throughX), 4);     // edge 16 >> 3 = 2: even, group left
    EXPECT_EQ(d::levelAfter(8, 8, d::ivec2(512, 256), throughX), 8);  // never above the coarsest
}

TEST(CellWalk, EdgesAndCellsFollowTheLevel) {
    EXPECT_EQ(d::blockEdge(d::ivec2(5, 9), 0), d::ivec2(6, 10));
    EXPECT_EQ(d::blockEdge(d::ivec2(5, 9), 2), d::ivec2(8, 12));
    EXPECT_EQ(d::cellAt(3.5, d::ivec2(4, 0), d::ivec2(8, 4), d::vec2(1, 0), d::vec2(1, 0)), d::ivec2(4, 0));
    EXPECT_EQ(d::cellAt(30, d::ivec2(4, 0), d::ivec2(8, 4), d::vec2(1, 0), d::vec2(1, 0)), d::ivec2(7, 0));
}

TEST(Column, IsMetByDescendingRaysAtTheTopAndByOthersAtTheSide) {
    // Down from z = 10 at 2 a metre: below 4 from t = 3 on.
    EXPECT_TRUE(d::meetsColumn(4, 10, -2, 2, 3.5));
    EXPECT_DOUBLE_EQ(d::columnTime(4, 10, -2, -0.5, 2, 3.5), 3);
    EXPECT_FALSE(d::meetsColumn(4, 10, -2, 2, 2.9));
    // Entering below the top: at once.
    EXPECT_DOUBLE_EQ(d::columnTime(4, 10, -2, -0.5, 3.2, 3.5), 3.2);
    // Rising: decided at the entry.
    EXPECT_TRUE(d::meetsColumn(4, 3, 1, 0.5, 9));
    EXPECT_DOUBLE_EQ(d::columnTime(4, 3, 1, 1, 0.5, 9), 0.5);
    EXPECT_FALSE(d::meetsColumn(4, 3, 1, 1.5, 9));
    // Horizontal, exactly on the top: solid includes its surface.
    EXPECT_TRUE(d::meetsColumn(4, 4, 0, 0, 9));
}

TEST(Column, TimeStaysInsideTheCellWhateverTheRounding) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0, 1);
    for (int i = 0; i < 100000; ++i) {
        const float enter = 100 * unit(random);
        const float exit = enter + unit(random) * 1e-3f;
        const float top = 65535 * unit(random);
        const float directionZ = -1e4f * unit(random);
        const float eyeZ = top + enter * -directionZ * (1 + 1e-6f * unit(random));
        if (!f::meetsColumn(top, eyeZ, directionZ, enter, exit)) continue;
        const float t = f::columnTime(top, eyeZ, directionZ, f::safeInverse(directionZ), enter, exit);
        EXPECT_GE(t, enter);
        EXPECT_LE(t, exit);
    }
}

TEST(Footprint, OfGroundSeenFromStraightAboveIsThePixelOnTheGround) {
    // 2 m texels, 100 m below, 500 pixels per unit slope: a texel spans 10 pixels, so a pixel 0.1 texels.
    const d::vec2 x = d::projected({2, 0, 0}, {0, 0}, 100, 500);
    const d::vec2 y = d::projected({0, -2, 0}, {0, 0}, 100, 500);
    EXPECT_DOUBLE_EQ(x.x, 10);
    EXPECT_DOUBLE_EQ(y.y, -10);
    const d::Footprint pixel = d::pixelFootprint(x, y, 128);
    EXPECT_DOUBLE_EQ(pixel.alongX.x, 0.1);
    EXPECT_DOUBLE_EQ(pixel.alongY.y, -0.1);
    EXPECT_DOUBLE_EQ(pixel.alongX.y, 0);
}

TEST(Footprint, InvertsTheProjectionOfAnyTiltedPlane) {
    const d::vec2 x(3, 1);
    const d::vec2 y(-0.5, 0.25);
    const d::Footprint pixel = d::pixelFootprint(x, y, 1e9);
    // A pixel to the right is alongX.x texels along x and alongX.y along y.
    EXPECT_NEAR(pixel.alongX.x * x.x + pixel.alongX.y * y.x, 1, 1e-12);
    EXPECT_NEAR(pixel.alongX.x * x.y + pixel.alongX.y * y.y, 0, 1e-12);
    EXPECT_NEAR(pixel.alongY.x * x.x + pixel.alongY.y * y.x, 0, 1e-12);
    EXPECT_NEAR(pixel.alongY.x * x.y + pixel.alongY.y * y.y, 1, 1e-12);
}

TEST(Footprint, IsBoundedAndFiniteEdgeOn) {
    for (const float skew : {0.0f, 1e-20f, -1e-20f}) {
        const f::Footprint pixel = f::pixelFootprint({1, 1}, {1, 1 + skew}, 128);
        EXPECT_TRUE(std::isfinite(pixel.alongX.x) && std::isfinite(pixel.alongY.y));
        EXPECT_LE(std::hypot(pixel.alongX.x, pixel.alongX.y), 128.1f);
        EXPECT_LE(std::hypot(pixel.alongY.x, pixel.alongY.y), 128.1f);
    }
}

TEST(Footprint, ProjectionOfAnObliqueDisplacementIsTheDerivativeOfThePicture) {
    // Picture position (x / z, y / z) * focal of a point, differentiated numerically.
    const d::vec3 point(20, -30, 200);
    const d::vec3 shift(0.3, 0.7, -0.4);
    const double focal = 800;
    const double h = 1e-6;
    const auto picture = [&](double s) {
        const d::vec3 p = point + s * shift;
        return d::vec2(focal * p.x / p.z, focal * p.y / p.z);
    };
    const d::vec2 numeric = (picture(h) - picture(-h)) / (2 * h);
    const d::vec2 closed = d::projected(shift, {point.x / point.z, point.y / point.z}, point.z, focal);
    EXPECT_NEAR(closed.x, numeric.x, 1e-6);
    EXPECT_NEAR(closed.y, numeric.y, 1e-6);
}

}  // namespace
