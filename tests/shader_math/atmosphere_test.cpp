// shaders/math/atmosphere.glsl: rays over a sphere against vectors in long double; phases against their integrals.

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/shader_math/both.h"

namespace {

using terray::test::kRoundoff;
using Wide = long double;

constexpr Wide kRadius = 6371000;
/// Metres that heightOf() loses to rounding, of the earth's radius.
constexpr double kReferenceError = 1e-12;
constexpr std::array kHeights = {1.5, 2.0, 100.0, 4300.0, 12000.0, 60000.0};
constexpr std::array kCosines = {1.0, 0.5, 0.02, 0.001, 0.0, -0.0005, -0.01, -0.06, -0.3, -1.0};

template <class Math>
class SphereRay : public testing::Test {};
TYPED_TEST_SUITE(SphereRay, terray::test::Precisions, terray::test::PrecisionNames);

/// Height over the sphere of a point on the ray, from its two coordinates.
double heightOf(Wide height, Wide cosine, Wide distance) {
    const Wide up = kRadius + height + distance * cosine;
    const Wide along = distance * std::sqrt(1 - cosine * cosine);
    return static_cast<double>(std::hypot(up, along) - kRadius);
}

TYPED_TEST(SphereRay, HeightsKeepTheirDigitsFarFromTheEarthsCentre) {
    using real = typename TypeParam::real;
    for (const double height : kHeights)
        for (const double cosine : kCosines)
            for (const double distance : {0.0, 1.0, 500.0, 20000.0, 400000.0}) {
                const auto c = static_cast<real>(cosine);
                const double expected = heightOf(static_cast<real>(height), c, distance);
                if (expected < -5000) continue;  // deep in the ground, where nobody asks
                // Relative to what is added up: the height, and what the ray gains and loses.
                const double size = height + std::abs(distance * cosine) + distance * distance / 1.2e7;
                EXPECT_NEAR(TypeParam::heightAlong(static_cast<real>(height), c, static_cast<real>(distance)), expected,
                            8 * kRoundoff<TypeParam> * size + kReferenceError)
                    << height << " " << cosine << " " << distance;
            }
}

TYPED_TEST(SphereRay, MeetsTheSeaWhereItsHeightIsNone) {
    using real = typename TypeParam::real;
    for (const double height : kHeights) {
        const auto h = static_cast<real>(height);
        const real horizon = TypeParam::horizonCosine(h);
        for (const double below : {0.0, 1e-4, 0.01, 0.5}) {
            const auto cosine = static_cast<real>(std::max(horizon - below, -1.0));
            const real distance = TypeParam::seaDistance(h, cosine);
            // At the horizon distance is the tangent's length; half of the digits are lost in its root.
            if (below == 0) {
                const auto tangent = static_cast<double>(std::sqrt(height * (2 * kRadius + height)));
                EXPECT_NEAR(distance / tangent, 1, 4 * std::sqrt(kRoundoff<TypeParam>)) << height;
            } else {
                EXPECT_NEAR(heightOf(h, cosine, distance), 0, 1e-6 + 1e-4 * height * (kRoundoff<TypeParam> > 1e-10))
                    << height << " " << below;
            }
        }
    }
}

TYPED_TEST(SphereRay, LeavesAndEntersAtTheTopOfTheAir) {
    using real = typename TypeParam::real;
    constexpr double kTop = 100000;
    for (const double height : kHeights)
        for (const double cosine : kCosines) {
            const auto c = static_cast<real>(cosine);
            const real distance = TypeParam::leavingDistance(static_cast<real>(height), c, real(kTop));
            EXPECT_NEAR(heightOf(static_cast<real>(height), c, distance), kTop, kRoundoff<TypeParam> * 1e8)
                << height << " " << cosine;
        }
    // From 400 km: straight down, aslant, and by the side of it or away from it.
    const real above = 400000;
    EXPECT_NEAR(TypeParam::enteringDistance(above, -1, real(kTop)), 300000, 300000 * 64 * kRoundoff<TypeParam>);
    const real aslant = TypeParam::enteringDistance(above, real(-0.4), real(kTop));
    EXPECT_NEAR(heightOf(above, real(-0.4), aslant), kTop, kRoundoff<TypeParam> * 1e8);
    EXPECT_LT(TypeParam::enteringDistance(above, real(-0.1), real(kTop)), 0);
    EXPECT_LT(TypeParam::enteringDistance(above, real(0.5), real(kTop)), 0);
}

TYPED_TEST(SphereRay, ZenithTurnsAlongTheRay) {
    using real = typename TypeParam::real;
    // A level ray towards a sun on the horizon: after a degree of the earth's turn the sun stands a degree higher.
    const double degree = M_PI / 180;
    const auto distance = static_cast<real>(double(kRadius) * std::tan(degree));
    const real height = TypeParam::heightAlong(0, 0, distance);
    EXPECT_NEAR(TypeParam::cosineAlong(0, distance, 0, 1, height), std::sin(degree), 1e-6);
    // Straight up and down nothing turns.
    EXPECT_NEAR(TypeParam::cosineAlong(0, 50000, real(0.3), real(0.3), 50000), 0.3, 8 * kRoundoff<TypeParam>);
}

template <class Math>
class Phase : public testing::Test {};
TYPED_TEST_SUITE(Phase, terray::test::Precisions, terray::test::PrecisionNames);

TYPED_TEST(Phase, ScattersAllLightSomewhere) {
    using real = typename TypeParam::real;
    constexpr int kPieces = 20000;
    double molecules = 0, aerosol = 0, mean = 0;
    for (int i = 0; i < kPieces; ++i) {
        const double cosine = -1 + 2 * (i + 0.5) / kPieces;
        const double share = 2 * M_PI * 2 / kPieces;
        molecules += share * TypeParam::moleculePhase(static_cast<real>(cosine));
        aerosol += share * TypeParam::aerosolPhase(static_cast<real>(cosine));
        mean += share * cosine * TypeParam::aerosolPhase(static_cast<real>(cosine));
    }
    EXPECT_NEAR(molecules, 1, 1e-5);
    EXPECT_NEAR(aerosol, 1, 1e-5);
    // Cornette and Shanks: the mean cosine is 3 g (4 + g^2) / (5 (2 + g^2)).
    constexpr double kG = 0.78;
    EXPECT_NEAR(mean, 3 * kG * (4 + kG * kG) / (5 * (2 + kG * kG)), 1e-5);
}

TYPED_TEST(Phase, VisualRangeIsSharedByMoleculesAndAerosol) {
    using real = typename TypeParam::real;
    // Green: 3.912 / range in all, of which 12.096e-6 are the molecules'.
    EXPECT_NEAR(TypeParam::aerosolExtinction(real(80000)).y + 12.096e-6, 3.912 / 80000, 1e-11);
    EXPECT_GT(TypeParam::aerosolExtinction(real(80000)).z, TypeParam::aerosolExtinction(real(80000)).x);
    // Beyond that of pure air there is none.
    EXPECT_EQ(TypeParam::aerosolExtinction(real(400000)).y, 0);
}

}  // namespace
