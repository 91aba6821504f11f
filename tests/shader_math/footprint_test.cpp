// shaders/math/footprint.glsl against closed forms: the ground that a pixel sees.

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "shaders/math/math.h"
#include "tests/common/random.h"
#include "tests/shader_math/both.h"

namespace {

namespace f = terray::mathf;
namespace d = terray::mathd;

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

template <class Math>
class FootprintOf : public testing::Test {};
TYPED_TEST_SUITE(FootprintOf, terray::test::Precisions, terray::test::PrecisionNames);

TYPED_TEST(FootprintOf, ADisplacementAlongTheRayIsAPoint) {
    // Vertical, horizontal or tilted: what lies behind one another falls on one pixel.
    using vec2 = typename TypeParam::vec2;
    for (const vec2 slope : {vec2(0, 0), vec2(0.5, 0), vec2(0, -0.75), vec2(0.25, 0.5)}) {
        const vec2 shift = TypeParam::projected({2 * slope.x, 2 * slope.y, 2}, slope, 50, 400);
        EXPECT_EQ(shift.x, 0);
        EXPECT_EQ(shift.y, 0);
    }
}

TYPED_TEST(FootprintOf, APlaneSeenAtASlopeIsLongerByItsInverse) {
    // Looking along y over flat ground from 100 m above it at 1000 m of view depth, falling by 1/10: a texel of 1 m
    // spans focal/depth pixels across and focal/depth * 1/10 along, so a pixel is ten times as long as wide.
    using real = typename TypeParam::real;
    const auto across = TypeParam::projected({1, 0, 0}, {0, -real(0.1)}, 1000, 500);
    const auto along = TypeParam::projected({0, 0, 1}, {0, -real(0.1)}, 1000, 500);
    const auto pixel = TypeParam::pixelFootprint(across, along, 1e6);
    const double bound = 8 * terray::test::kRoundoff<TypeParam>;
    EXPECT_NEAR(pixel.alongX.x, 2, 2 * bound);
    EXPECT_NEAR(pixel.alongX.y, 0, 2 * bound);
    EXPECT_NEAR(pixel.alongY.x, 0, 20 * bound);
    EXPECT_NEAR(pixel.alongY.y, 20, 20 * bound);
}

TYPED_TEST(FootprintOf, AMirroredTexelBasisMirrorsThePixel) {
    using real = typename TypeParam::real;
    const auto upright = TypeParam::pixelFootprint({4, 1}, {-1, 2}, 1e6);
    const auto mirrored = TypeParam::pixelFootprint({-4, -1}, {-1, 2}, 1e6);
    EXPECT_EQ(mirrored.alongX.x, -upright.alongX.x);
    EXPECT_EQ(mirrored.alongX.y, upright.alongX.y);
    EXPECT_NEAR(upright.alongX.x, real{2} / real{9}, 1e-6);
}

TYPED_TEST(FootprintOf, AllFinitePixelsIsNoLongerThanItsLimit) {
    terray::test::Random random(5);
    for (int i = 0; i < 10000; ++i) {
        const auto number = [&] {
            return static_cast<typename TypeParam::real>(random.between(-1, 1) * std::pow(10, random.between(-18, 4)));
        };
        const auto pixel = TypeParam::pixelFootprint({number(), number()}, {number(), number()}, 128);
        EXPECT_LE(std::hypot(double{pixel.alongX.x}, double{pixel.alongX.y}), 128.1) << i;
        EXPECT_LE(std::hypot(double{pixel.alongY.x}, double{pixel.alongY.y}), 128.1) << i;
    }
}

}  // namespace
