// shaders/math/patch.glsl against closed forms: rays over bilinear patches.

#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "tests/common/random.h"
#include "tests/shader_math/both.h"
#include "tests/shader_math/walks.h"

namespace {

using terray::test::Double;
using terray::test::Heights;
using terray::test::kRoundoff;
using terray::test::Random;
using terray::test::Ray;
using terray::test::Worst;

template <class Math>
class Patch : public testing::Test {
  protected:
    static typename Math::real contact(typename Math::Corners corners, typename Math::vec3 at,
                                       typename Math::vec3 direction, typename Math::real span,
                                       typename Math::real bend = 0) {
        return Math::firstContact(Math::patchClearance(corners, at, direction, bend), span);
    }
};
TYPED_TEST_SUITE(Patch, terray::test::Precisions, terray::test::PrecisionNames);

TYPED_TEST(Patch, HeightIsThatOfTheCornersEdgesAndCentre) {
    const typename TypeParam::Corners corners = {3, 5, 11, 21};
    EXPECT_EQ(TypeParam::patchHeight(corners, 0, 0), 3);
    EXPECT_EQ(TypeParam::patchHeight(corners, 1, 0), 5);
    EXPECT_EQ(TypeParam::patchHeight(corners, 0, 1), 11);
    EXPECT_EQ(TypeParam::patchHeight(corners, 1, 1), 21);
    EXPECT_EQ(TypeParam::patchHeight(corners, 0.5, 0), 4);
    EXPECT_EQ(TypeParam::patchHeight(corners, 1, 0.5), 13);
    EXPECT_EQ(TypeParam::patchHeight(corners, 0.5, 0.5), 10);
}

TYPED_TEST(Patch, OfASaddleIsMetAtItsKnownRoots) {
    using Corners = typename TypeParam::Corners;
    using real = typename TypeParam::real;
    const Corners saddle = {0, 0, 0, 1};  // h = u v
    // Level along the diagonal u = v = s: s^2 = z.
    EXPECT_EQ(this->contact(saddle, {0, 0, 0.25}, {1, 1, 0}, 1), 0.5);
    EXPECT_EQ(this->contact(saddle, {0, 0, 1}, {1, 1, 0}, 1), 1) << "at the very corner";
    // Level along the other one, v = 1 - u: s - s^2 = z, a double root at z = 1/4 and two at 3/16.
    EXPECT_EQ(this->contact(saddle, {0, 1, 0.25}, {1, -1, 0}, 1), 0.5);
    EXPECT_EQ(this->contact(saddle, {0, 1, 0.1875}, {1, -1, 0}, 1), 0.25);
    EXPECT_EQ(this->contact(saddle, {0, 1, 0.2578125}, {1, -1, 0}, 1), -1) << "2^-7 above the ridge";
    // Along v = 1/2 the saddle is a line: 4/8 - s/4 = s/2 at 2/3.
    EXPECT_NEAR(this->contact(saddle, {0, 0.5, 0.5}, {1, 0, -real(0.25)}, 1), 2.0 / 3, 4 * kRoundoff<TypeParam>);
    // Down: on the ground under the ray.
    EXPECT_EQ(this->contact(saddle, {0.25, 0.5, 2}, {0, 0, -4}, 1), 0.46875);
}

TYPED_TEST(Patch, OfAPlaneIsMetAsThePlane) {
    using Corners = typename TypeParam::Corners;
    using real = typename TypeParam::real;
    const Corners plane = {10, 12, 14, 16};  // 10 + 2 u + 4 v: no twist, the quadratic is a line
    EXPECT_EQ(TypeParam::patchClearance(plane, {0.25, 0.5, 20}, {1, 1, 1}, 0).bend, 0);
    EXPECT_EQ(this->contact(plane, {0, 0, 13}, {1, 0, 0}, 1), -1) << "level along an edge, above its end";
    EXPECT_EQ(this->contact(plane, {0, 0, 11}, {1, 0, 0}, 1), 0.5) << "level along an edge";
    EXPECT_EQ(this->contact(plane, {0, 0, 13}, {0, 1, 0}, 1), 0.75) << "level along the other edge";
    EXPECT_EQ(this->contact(plane, {0, 0, 13}, {1, 1, 0}, 1), 0.5) << "level along the diagonal";
    EXPECT_EQ(this->contact(plane, {0, 0, 10}, {1, 1, 6}, 1), 0) << "within the plane itself";
    EXPECT_EQ(this->contact(plane, {0, 0, 10.5}, {1, 1, 6}, 1), -1) << "in parallel above it";
    EXPECT_EQ(this->contact(plane, {0.5, 0.25, 15}, {0, 0, -real(0.5)}, 8), 6) << "down";
    EXPECT_EQ(this->contact(plane, {1, 1, 16}, {0, 0, 0}, 1), 0) << "on a corner, not moving";
}

TYPED_TEST(Patch, ClearanceIsHeightOfTheRayMinusHeightOfTheSurfaceEverywhere) {
    Random random(4);
    Worst worst("worst_clearance");
    for (int i = 0; i < 50000; ++i) {
        using real = typename TypeParam::real;
        const auto code = [&] { return static_cast<real>(random.below(65536)); };
        const auto number = [&](double low, double high) { return static_cast<real>(random.between(low, high)); };
        const typename TypeParam::Corners corners = {code(), code(), code(), code()};
        const typename TypeParam::vec3 at(number(0, 1), number(0, 1), code());
        const typename TypeParam::vec3 direction(number(-1, 1), number(-1, 1), number(-1e5, 1e5));
        const real bend = number(0, 100);
        const auto clearance = TypeParam::patchClearance(corners, at, direction, bend);
        const double s = random.between(0, 1);
        const Double::Corners exact = {corners.h00, corners.h10, corners.h01, corners.h11};
        const double ray = at.z + s * (double{direction.z} + s * bend);
        const double ground = Double::patchHeight(exact, at.x + s * direction.x, at.y + s * direction.y);
        const double found = (clearance.bend * s + clearance.slope) * s + clearance.start;
        // The codes' differences are exact in float (17 bits); each coefficient has up to five roundings of such
        // numbers.
        const double bound = 8 * kRoundoff<TypeParam> * (4 * 65536.0 + 1e5);
        ASSERT_TRUE(worst.holds(found - (ray - ground), bound)) << i;
    }
}

TYPED_TEST(Patch, OfAStepIsMetOnItsRiser) {
    // 0 up to x = 7, 16 from x = 8 on: a ramp between.
    const Heights step(16, [](int x, int) { return x < 8 ? 0 : 16; });
    const auto first = [&](Ray<TypeParam> ray) { return terray::test::walkPatches<TypeParam>(step, ray); };
    EXPECT_EQ(first({{-2, 3.5, 4}, {1, 0, 0}}), 9.25);
    EXPECT_EQ(first({{-2, 3, 16}, {1, 0, 0}}), 10) << "along a row of samples, to the step's upper edge";
    EXPECT_EQ(first({{-2, 3, 16.5}, {1, 0, 0}}), std::nullopt);
    EXPECT_EQ(first({{3.5, 3.5, 4}, {0, 0, -1}}), 4) << "down on the level ground";
    EXPECT_EQ(first({{7.5, 3.5, 12}, {0, 0, -1}}), 4) << "down on the riser";
    EXPECT_EQ(first({{0, 0, 4}, {1, 1, 0}}), 7.25) << "through corners only";
    EXPECT_EQ(first({{4, -2, 0}, {0, 1, 0}}), 2) << "level on the ground itself";
}

TYPED_TEST(Patch, OfASampledConeIsMetWhereTheConesRowOfSamplesIs) {
    // Along the rows and columns of samples through its apex a sampled cone is the cone.
    const Heights cone(17, [](int x, int y) { return 100 - 10 * std::hypot(x - 8, y - 8); });
    const auto first = [&](Ray<TypeParam> ray) { return terray::test::walkPatches<TypeParam>(cone, ray); };
    EXPECT_EQ(first({{-2, 8, 70}, {1, 0, 0}}), 7);
    EXPECT_EQ(first({{8, -4, 50}, {0, 1, 0}}), 7);
    EXPECT_EQ(first({{8, 8, 130}, {0, 0, -2}}), 15) << "the apex from above";
    EXPECT_EQ(first({{-2, 8, 100}, {1, 0, 0}}), 10) << "the apex from the side";
    EXPECT_EQ(first({{-2, 8, 100.5}, {1, 0, 0}}), std::nullopt);
}

TYPED_TEST(Patch, OfASampledConeIsMetAsDensePointsSay) {
    const Heights cone(33, [](int x, int y) { return 400 - 12 * std::hypot(x - 15.3, y - 16.1); });
    Random random(6);
    Worst worst("worst_clearance");
    int met = 0;
    for (int i = 0; i < 1000; ++i) {
        const typename TypeParam::vec3 eye(random.between(-40, 5), random.between(-10, 20), random.between(100, 600));
        const typename TypeParam::vec3 direction(random.between(0.05, 1), random.between(0, 0.5),
                                                 random.between(-15, 3));
        const Ray<TypeParam> ray = {eye, direction};
        const auto found = terray::test::walkPatches<TypeParam>(cone, ray);
        const double end = found ? double{*found} : 1000;
        for (double t = 0; t < end; t += 1.0 / 64) {
            if (ray.x(t) < 0 || ray.y(t) < 0) continue;
            if (ray.x(t) > 32 || ray.y(t) > 32) break;
            ASSERT_GE(ray.height(t) - cone.bilinear(ray.x(t), ray.y(t)), -clearanceBound(ray, cone, t)) << i;
        }
        // A ray that starts below the ground, or enters below the rim of the grid, touches there.
        const auto above = [&](double t) { return ray.height(t) - cone.bilinear(ray.x(t), ray.y(t)); };
        const bool side = found && (end == 0 || std::abs(ray.x(end)) < 1e-4 || std::abs(ray.y(end)) < 1e-4);
        if (!found || (side && above(end) < 0)) continue;
        ++met;
        ASSERT_TRUE(worst.holds(above(end), clearanceBound(ray, cone, end))) << i;
    }
    EXPECT_GT(met, 200);
}

}  // namespace
