// shaders/math/air.glsl: columns of air against sums of many short pieces in long double.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/shader_math/both.h"

namespace {

using terray::test::kRoundoff;

constexpr double kScale = 8434;
/// What meanDecay's series leaves out at its end, 1/8: x^5 / 720.
constexpr double kSeries = 4.3e-8;

template <class Math>
class AirColumn : public testing::Test {};
TYPED_TEST_SUITE(AirColumn, terray::test::Precisions, terray::test::PrecisionNames);

/// airColumn() of numbers that may be rounded.
template <class Math>
double column(double from, double to, double length) {
    using real = typename Math::real;
    return Math::airColumn(static_cast<real>(from), static_cast<real>(to), static_cast<real>(length), real(kScale));
}
template <class Math>
double columnToSpace(double from, double rise) {
    using real = typename Math::real;
    return Math::airColumnToSpace(static_cast<real>(from), static_cast<real>(rise), real(kScale));
}

/// Simpson's rule, whose error is far below a float's roundoff here.
double summed(double from, double to, double length) {
    constexpr int kPieces = 2000;
    long double sum = 0;
    for (int i = 0; i <= kPieces; ++i) {
        const long double height = from + (to - from) * static_cast<long double>(i) / kPieces;
        sum += std::exp(-height / kScale) * (i == 0 || i == kPieces ? 1 : i % 2 == 1 ? 4 : 2);
    }
    return static_cast<double>(sum * length / (3 * kPieces));
}

TYPED_TEST(AirColumn, MatchesASumOnEveryPath) {
    for (const double from : {-400.0, 0.0, 2.0, 3000.0, 12000.0})
        for (const double to : {-400.0, 0.0, 1.0, 2.0, 2.001, 1000.0, 3000.5, 9000.0, 60000.0}) {
            const double expected = summed(from, to, 50000);
            EXPECT_NEAR(column<TypeParam>(from, to, 50000), expected, (8 * kRoundoff<TypeParam> + kSeries) * expected)
                << from << " to " << to;
        }
}

TYPED_TEST(AirColumn, BetweenEqualHeightsIsLengthTimesDensity) {
    for (const double height : {0.0, 2.0, 8434.0}) {
        const double expected = 70000 * std::exp(-height / kScale);
        EXPECT_NEAR(column<TypeParam>(height, height, 70000), expected, 4 * kRoundoff<TypeParam> * expected);
        // Nor does it jump where heights differ by a float's last place, or by a metre.
        for (const double step : {1e-3, 0.1, 1.0})
            EXPECT_NEAR(column<TypeParam>(height, height + step, 70000), expected * (1 - step / kScale / 2),
                        expected * (6 * kRoundoff<TypeParam> + step * step / kScale / kScale));
    }
}

TYPED_TEST(AirColumn, IsTheSameInBothDirections) {
    for (const double other : {0.0, 500.0, 9000.0})
        EXPECT_EQ(column<TypeParam>(1200, other, 30000), column<TypeParam>(other, 1200, 30000));
}

TYPED_TEST(AirColumn, MeanDecayJoinsItsTwoForms) {
    // On both sides of the change at 1/8, against the closed form in long double.
    for (const double x : {1e-9, 1e-3, 0.1, 0.12499, 0.125, 0.12501, 0.2, 3.0, 80.0}) {
        const auto given = static_cast<typename TypeParam::real>(x);
        const auto wide = static_cast<long double>(given);
        const auto expected = static_cast<double>(-std::expm1(-wide) / wide);
        // The series leaves out x^5 / 720; the difference loses up to 3 bits.
        const double bound = 20 * kRoundoff<TypeParam> + (x < 0.125 ? std::pow(x, 5) / 650 : 0);
        EXPECT_NEAR(TypeParam::meanDecay(given), expected, bound * expected) << x;
    }
    EXPECT_EQ(TypeParam::meanDecay(0), 1);
}

TYPED_TEST(AirColumn, ToSpaceIsTheLimitOfLongPaths) {
    for (const double rise : {1.0, 0.1, 0.01}) {
        const double length = 40 * kScale / rise;
        const double expected = summed(100, 100 + 40 * kScale, length);
        EXPECT_NEAR(columnToSpace<TypeParam>(100, rise), expected, 1e-5 * expected);
    }
    // Along the ground it has no end.
    EXPECT_GT(columnToSpace<TypeParam>(100, 0), 1e9);
    EXPECT_GT(columnToSpace<TypeParam>(100, -0.5), 1e9);
}

}  // namespace
