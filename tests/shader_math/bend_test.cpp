// shaders/math/bend.glsl: bent rays, alone and over columns, against dense points in double.

#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "tests/common/random.h"
#include "tests/shader_math/both.h"
#include "tests/shader_math/walks.h"

namespace {

using terray::test::Heights;
using terray::test::kRoundoff;
using terray::test::Random;
using terray::test::Ray;

template <class Math>
class Bend : public testing::Test {};
TYPED_TEST_SUITE(Bend, terray::test::Precisions, terray::test::PrecisionNames);

TYPED_TEST(Bend, OfNothingIsAStraightRay) {
    for (const float t : {0.0f, 1.0f, 1000.0f}) EXPECT_EQ(TypeParam::bentHeight(100, -0.25, 0, t), 100 - t / 4);
    EXPECT_EQ(TypeParam::bentSlope(-0.25, 0, 1000), -0.25);
}

TYPED_TEST(Bend, GainsTheDropOfAGlobe) {
    // 100 km over a sphere of 6371 km: d^2 / 2 R = 784.8 m.
    using real = typename TypeParam::real;
    const real bend = real(1.0 / (2 * 6371e3));
    EXPECT_NEAR(TypeParam::bentHeight(0, 0, bend, real(1e5)), 784.80615, 784.9 * 4 * kRoundoff<TypeParam> + 1e-5);
    EXPECT_NEAR(TypeParam::bentSlope(0, bend, real(1e5)), 1e5 / 6371e3, 0.016 * 4 * kRoundoff<TypeParam>);
}

TYPED_TEST(Bend, DropIsTheFormAndFallItsGradient) {
    using vec3 = typename TypeParam::vec3;
    // Powers of two: every operation is exact, and central differences of a quadratic are.
    const vec3 form(2, 0.5f, 4);
    EXPECT_EQ(TypeParam::earthDrop(form, 8, -2), 2 * 64 - 0.5 * 16 + 4 * 4);
    for (const float east : {-8.0f, 0.0f, 4.0f})
        for (const float north : {-16.0f, 2.0f}) {
            const auto fall = TypeParam::earthFall(form, east, north);
            EXPECT_EQ(fall.x,
                      (TypeParam::earthDrop(form, east + 1, north) - TypeParam::earthDrop(form, east - 1, north)) / 2);
            EXPECT_EQ(fall.y,
                      (TypeParam::earthDrop(form, east, north + 1) - TypeParam::earthDrop(form, east, north - 1)) / 2);
        }
}

TYPED_TEST(Bend, SlopeIsTheDerivativeOfTheHeight) {
    // Central differences of a parabola are exact; with powers of two so is every operation.
    for (const float t : {0.0f, 4.0f, 64.0f})
        EXPECT_EQ((TypeParam::bentHeight(8, -2, 0.25, t + 1) - TypeParam::bentHeight(8, -2, 0.25, t - 1)) / 2,
                  TypeParam::bentSlope(-2, 0.25, t));
}

TYPED_TEST(Bend, OverAColumnDecidesAsExactArithmeticUnlessTheRayGrazes) {
    // Codes of 1 cm to 1 m, lines of sight of up to 600 km, over an earth as it is: eye and drop reach 1e6 codes.
    using real = typename TypeParam::real;
    Random random(77);
    int touched = 0, atVertex = 0;
    for (int i = 0; i < 200000; ++i) {
        const auto any = [&](double low, double high) { return static_cast<real>(random.between(low, high)); };
        const real top = any(0, 65535), bend = static_cast<real>(std::pow(10.0, random.between(-12, -5.5)));
        real eyeZ = any(0, 1e6), dz = any(-6, 1), enter = any(0, 6e5);
        if (i % 2 == 0) {  // within 20 km of its lowest point, about as high as the top
            dz = -2 * bend * (enter + any(0, 2e4));
            eyeZ = top + dz * dz / (4 * bend) - bend * any(-4e8, 4e8);
        }
        const real exit = enter + any(0, 5e4);
        const real lowest = TypeParam::lowestTime(dz, bend);
        const double vertex = -double{dz} / (2 * double{bend});
        const double at = std::max(double{enter}, std::min(vertex, double{exit}));
        const auto clearance = [&](double t) {
            return (double{bend} * t + double{dz}) * t + double{eyeZ} - double{top};
        };
        const auto rounding = [&](double t) {
            return 6 * kRoundoff<TypeParam> * (double{eyeZ} + std::abs(double{dz} * t) + double{bend} * t * t + 65535);
        };
        const bool meets = TypeParam::bentMeetsColumn(top, eyeZ, dz, bend, lowest, enter, exit);
        if (std::abs(clearance(at)) > rounding(at)) {
            ASSERT_EQ(meets, clearance(at) <= 0) << i;
        }
        if (!meets) continue;
        ++touched;
        atVertex += clearance(enter) > 0 && clearance(exit) > 0 ? 1 : 0;
        const double t = TypeParam::bentColumnTime(top, eyeZ, dz, bend, enter, exit);
        ASSERT_GE(t, enter);
        ASSERT_LE(t, exit);
        ASSERT_LE(clearance(t), rounding(t)) << i << ": above the column";
        // Not late: it is where the ray enters, or at the height of the top.
        if (t > enter) {
            ASSERT_GE(clearance(t), -rounding(t)) << i;
        }
    }
    EXPECT_GT(touched, 10000);
    EXPECT_GT(atVertex, 100) << "rays that dip within a column are among the cases";
}

TYPED_TEST(Bend, OverOneColumnTouchesAtTheParabolasRoots) {
    // 10 - 6 t + t^2 over level 5: roots 1 and 5; over level 1: (t - 3)^2; over level 0: none.
    const auto first = [](int top) {
        return terray::test::walkColumns<TypeParam>(Heights(16, [&](int, int) { return top; }),
                                                    {{0, 0.5, 10}, {1, 0, -6}, 1});
    };
    EXPECT_EQ(first(5), 1);
    EXPECT_EQ(first(1), 3) << "tangent, exactly between two cells";
    EXPECT_EQ(first(0), std::nullopt);
}

TYPED_TEST(Bend, OverColumnsTouchesWhereDensePointsFirstLieInside) {
    Random random(8);
    int met = 0;
    int dipped = 0;  // rays that touch while falling although they rise again before they leave the column
    for (int i = 0; i < 2000; ++i) {
        const Heights hills(24, [&](int x, int y) {
            return 40 + 30 * std::sin(0.4 * x + 0.1 * i) * std::cos(0.3 * y) + random.between(0, 4);
        });
        const typename TypeParam::vec3 eye(random.between(-30, 10), random.between(-20, 20), random.between(60, 120));
        const typename TypeParam::vec3 direction(random.between(0.2, 1), random.between(0, 0.6), random.between(-8, 0));
        const Ray<TypeParam> ray = {eye, direction, static_cast<typename TypeParam::real>(random.between(0.01, 0.4))};
        const auto found = terray::test::walkColumns<TypeParam>(hills, ray);
        met += found.has_value();
        const double end = found ? double{*found} : 1000;
        for (double t = 0; t < end - 1e-4; t += 1.0 / 256) {
            const double x = ray.x(t);
            const double y = ray.y(t);
            if (x < 0 || y < 0) continue;
            if (x > 24 || y > 24) break;
            // Within 1e-4 texels of a column's side rounding may take it for its neighbour.
            if (std::min(std::abs(x - std::round(x)), std::abs(y - std::round(y))) < 1e-4) continue;
            ASSERT_GT(ray.height(t), hills.column(x, y) - 1e-3) << i << " at " << t;
        }
        if (!found) continue;
        double lowest = 1e9;
        for (const double x : {-1e-4, 1e-4})
            for (const double y : {-1e-4, 1e-4})
                lowest = std::min(lowest, ray.height(end) - hills.column(ray.x(end) + x, ray.y(end) + y));
        EXPECT_LE(lowest, 1e-3) << i;
        const double vertex = -double{direction.z} / (2 * double{ray.bend});
        dipped += end < vertex && hills.column(ray.x(end), ray.y(end)) == hills.column(ray.x(vertex), ray.y(vertex));
    }
    EXPECT_GT(met, 300);
    EXPECT_GT(dipped, 5);
}

}  // namespace
