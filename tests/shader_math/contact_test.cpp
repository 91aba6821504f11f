// shaders/math/contact.glsl against closed forms, and its float against exact signs and roots.
//
// Rounding: u = 2^-24 (float) or 2^-53 (double), M(s) = |bend| s^2 + |slope| s + start. From the operations' own
// errors:
//  - at the end of the span a clearance is wrong by 4 u M(span) at most, the lowest one between by 3 u M(span); so a
//  decision is
//    certain once the exact lowest clearance is 5 u M(span) away from 0;
//  - at the contact the exact clearance is within 12 u M(s) of 0, double roots included;
//  - apart from a double root, s itself is off by (6 + 3 k) u s at most, k = (slope^2 + 4 |bend start|) / discriminant.
// Measured in float, double alike (test properties worst_*): decisions 0.21, clearances 0.26, roots 0.43 of their
// bounds.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/common/random.h"
#include "tests/shader_math/both.h"

namespace {

using terray::test::Double;
using terray::test::kRoundoff;
using terray::test::Random;
using terray::test::Worst;

constexpr int kNone = -1;

template <class Math>
class FirstContact : public testing::Test {
  protected:
    static typename Math::real of(typename Math::real bend, typename Math::real slope, typename Math::real start,
                                  typename Math::real span) {
        return Math::firstContact({.bend = bend, .slope = slope, .start = start}, span);
    }
};
TYPED_TEST_SUITE(FirstContact, terray::test::Precisions, terray::test::PrecisionNames);

TYPED_TEST(FirstContact, OfALineIsItsRoot) {
    EXPECT_EQ(this->of(0, -2, 6, 4), 3);
    EXPECT_EQ(this->of(0, -2, 6, 3), 3) << "exactly at the end of the span";
    EXPECT_EQ(this->of(0, -2, 6, 2.75), kNone);
    EXPECT_EQ(this->of(0, 2, 6, 100), kNone) << "rising";
    EXPECT_EQ(this->of(0, 0, 6, 100), kNone) << "level";
}

TYPED_TEST(FirstContact, SurvivesALeadingCoefficientNearZeroOfEitherSign) {
    using real = typename TypeParam::real;
    for (const double bend : {0.0, -0.0, 1e-30, -1e-30, 1e-38, -1e-38, 1e-44, -1e-44}) {
        const auto a = static_cast<real>(bend);
        EXPECT_EQ(this->of(a, -2, 6, 4), 3) << bend;
        EXPECT_EQ(this->of(a, 2, 6, 4), kNone) << bend;
        EXPECT_EQ(this->of(a, 0, 6, 4), kNone) << bend;
        EXPECT_EQ(this->of(a, 0, 0, 4), 0) << bend;
    }
    // So far away that it matters: 1 - 1e-30 s^2 is 0 at 1e15.
    EXPECT_NEAR(this->of(real(-1e-30), 0, 1, real(2e15)), 1e15, 1e15 * 4 * kRoundoff<TypeParam>);
}

TYPED_TEST(FirstContact, OfAParabolaIsItsFirstRootWhicheverWayItOpens) {
    EXPECT_EQ(this->of(1, -4, 3, 10), 1) << "roots 1 and 3, both inside";
    EXPECT_EQ(this->of(1, -4, 3, 2), 1) << "the second one outside";
    EXPECT_EQ(this->of(1, -4, 3, 1), 1) << "exactly at the end of the span";
    EXPECT_EQ(this->of(1, -4, 3, 0.9375), kNone);
    EXPECT_EQ(this->of(-1, 2, 3, 10), 3) << "roots -1 and 3";
    EXPECT_EQ(this->of(-1, 2, 3, 3), 3);
    EXPECT_EQ(this->of(-1, 2, 3, 2.5), kNone);
    EXPECT_EQ(this->of(-1, -2, 3, 10), 1) << "roots -3 and 1";
    EXPECT_EQ(this->of(-1, 0, 4, 10), 2) << "level at the start";
    EXPECT_EQ(this->of(1, 4, 3, 10), kNone) << "roots -3 and -1";
    EXPECT_EQ(this->of(1, -2, 3, 10), kNone) << "no root";
}

TYPED_TEST(FirstContact, TouchesAtATangentAndAtADoubleRoot) {
    EXPECT_EQ(this->of(1, -2, 1, 10), 1) << "(s - 1)^2";
    EXPECT_EQ(this->of(4, -4, 1, 0.5), 0.5) << "(2 s - 1)^2, at the end of the span";
    EXPECT_EQ(this->of(4, -4, 1, 0.4375), kNone);
    EXPECT_EQ(this->of(1, -2, 1.0009765625, 10), kNone) << "2^-10 above";
    EXPECT_EQ(this->of(1, -2, 0.9375, 10), 0.75) << "2^-4 below";
}

TYPED_TEST(FirstContact, OfARayThatStartsAtOrBelowTheGroundIsItsStart) {
    for (const float start : {0.0f, -1.0f, -1000.0f})
        for (const float slope : {-3.0f, 0.0f, 3.0f})
            for (const float bend : {-2.0f, 0.0f, 2.0f}) EXPECT_EQ(this->of(bend, slope, start, 5), 0);
    EXPECT_EQ(this->of(1, 1, 0, 0), 0) << "a span of no length";
    EXPECT_EQ(this->of(1, -1, 1, 0), kNone);
}

/// Clearances of all magnitudes, a third of them constructed to graze the ground or the end of the span.
template <class Math>
struct Case {
    typename Math::Clearance clearance;
    typename Math::real span;
};

template <class Math>
Case<Math> randomCase(Random& random) {
    using real = typename Math::real;
    const auto magnitude = [&](double low, double high) { return std::pow(10, random.between(low, high)); };
    const auto sign = [&] { return random.below(2) == 0 ? 1.0 : -1.0; };
    const double span = magnitude(-4, 4);
    double slope = sign() * magnitude(-4, 4);
    double bend = sign() * magnitude(-8, 4);
    double start = magnitude(-4, 5);
    const auto kind = random.below(6);
    if (kind == 0) {  // a vertex inside, near the ground
        slope = -std::abs(slope);
        bend = -slope / (2 * span * random.between(0.1, 1.1));
        start = slope * slope / (4 * bend) * (1 + sign() * magnitude(-17, -1));
    } else if (kind == 3) {  // a vertex on the ground and at the end of the span, but for rounding
        slope = -std::abs(slope);
        bend = -slope / (2 * span) * (1 + sign() * magnitude(-17, -4));
        start = slope * slope / (4 * bend) * (1 + sign() * magnitude(-17, -6));
    } else if (kind == 1) {  // near the ground at the end of the span
        const double change = (bend * span + slope) * span;
        start = std::abs(change) * (1 + sign() * magnitude(-17, -1));
    } else if (kind == 2) {
        bend = 0;
    }
    return {{static_cast<real>(bend), static_cast<real>(slope), static_cast<real>(start)}, static_cast<real>(span)};
}

/// The same clearance in long double, where what double rounds away still shows.
struct Exact {
    long double bend, slope, start, span;

    template <class Math>
    explicit Exact(const Case<Math>& of)
        : bend(of.clearance.bend), slope(of.clearance.slope), start(of.clearance.start), span(of.span) {}

    [[nodiscard]] long double at(long double s) const { return (bend * s + slope) * s + start; }
    [[nodiscard]] long double lowest() const {
        long double result = std::min(start, at(span));
        if (bend > 0 && slope < 0 && -slope < 2 * bend * span) result = std::min(result, at(-slope / (2 * bend)));
        return result;
    }
    [[nodiscard]] double magnitude(long double s) const {
        return static_cast<double>((std::abs(bend) * s + std::abs(slope)) * s + std::abs(start));
    }
    [[nodiscard]] long double discriminant() const { return slope * slope - 4 * bend * start; }
    [[nodiscard]] double condition() const {
        return static_cast<double>((slope * slope + 4 * std::abs(bend * start)) / discriminant());
    }
    /// The first root, for a start above the ground and a contact within the span.
    [[nodiscard]] long double root() const {
        const long double r = std::sqrt(discriminant());
        return slope < 0 ? 2 * start / (r - slope) : (r + slope) / (-2 * bend);
    }
};

TYPED_TEST(FirstContact, AlwaysTouchesWhenTheRayLeavesBelow) {
    Random random(1);
    int below = 0;
    for (int i = 0; i < 300000; ++i) {
        const auto [clearance, span] = randomCase<TypeParam>(random);
        if (TypeParam::clearanceAt(clearance, span) > 0) continue;
        ++below;
        const auto s = TypeParam::firstContact(clearance, span);
        ASSERT_TRUE(s >= 0 && s <= span) << i << ": " << clearance.bend << ' ' << clearance.slope << ' '
                                         << clearance.start << " over " << span << " gave " << s;
    }
    EXPECT_GT(below, 50000);
}

TYPED_TEST(FirstContact, DecidesAsExactArithmeticUnlessTheRayGrazes) {
    Random random(2);
    Worst worst("worst_decision");
    int touching = 0;
    int differing = 0;
    for (int i = 0; i < 300000; ++i) {
        const auto of = randomCase<TypeParam>(random);
        const Exact exact(of);
        const bool touches = TypeParam::firstContact(of.clearance, of.span) >= 0;
        touching += touches;
        if (touches == (exact.lowest() <= 0)) continue;
        ++differing;
        ASSERT_TRUE(
            worst.holds(static_cast<double>(exact.lowest()), 5 * kRoundoff<TypeParam> * exact.magnitude(exact.span)))
            << i;
    }
    EXPECT_GT(touching, 50000);
    EXPECT_GT(differing, 100) << "grazing rays are among the cases";
}

TYPED_TEST(FirstContact, LiesOnTheGroundAndNearTheRoot) {
    Random random(3);
    Worst clearance("worst_clearance");
    Worst distance("worst_root");
    int roots = 0;
    for (int i = 0; i < 300000; ++i) {
        const auto of = randomCase<TypeParam>(random);
        const double s = TypeParam::firstContact(of.clearance, of.span);
        if (s < 0) continue;
        const Exact exact(of);
        const double u = kRoundoff<TypeParam>;
        ASSERT_TRUE(clearance.holds(static_cast<double>(exact.at(s)), 12 * u * exact.magnitude(s))) << i;
        if (exact.lowest() > 0 || exact.discriminant() <= 0 || exact.condition() > 0.01 / u) continue;
        ++roots;
        const double root = static_cast<double>(std::min(exact.root(), exact.span));
        ASSERT_TRUE(distance.holds(s - root, (6 + 3 * exact.condition()) * u * root)) << i << ' ' << root;
    }
    EXPECT_GT(roots, 50000);
}

template <class Math>
class RiseTime : public testing::Test {};
TYPED_TEST_SUITE(RiseTime, terray::test::Precisions, terray::test::PrecisionNames);

TYPED_TEST(RiseTime, IsTheLaterRootOfARayThatStartsBelow) {
    using Clearance = typename TypeParam::Clearance;
    EXPECT_EQ(TypeParam::riseTime(Clearance{1, 2, -3}), 1) << "(s + 3) (s - 1)";
    EXPECT_EQ(TypeParam::riseTime(Clearance{1, -2, -3}), 3) << "(s + 1) (s - 3), sinking first";
    EXPECT_EQ(TypeParam::riseTime(Clearance{4, 0, -16}), 2);
    EXPECT_EQ(TypeParam::riseTime(Clearance{0, 2, -8}), 4) << "a straight ray";
    EXPECT_GT(TypeParam::riseTime(Clearance{0, -2, -8}), 1e30) << "one that never comes up";
}

TYPED_TEST(RiseTime, LosesNoDigitsWhereTheBendIsNearZero) {
    // 300 km at a slope of 1 %, bent by an earth of 6371 km, from 20 km below; and the same hardly bent.
    using real = typename TypeParam::real;
    for (const double bend : {7.8e-8, 1e-12, 1e-20})
        for (const double slope : {0.01, -0.01}) {
            const double start = -20e3;
            const double root = std::sqrt(slope * slope - 4 * bend * start);
            const double exact = slope > 0 ? -2 * start / (root + slope) : (root - slope) / (2 * bend);
            const double found = TypeParam::riseTime({real(bend), real(slope), real(start)});
            EXPECT_NEAR(found, exact, 8 * kRoundoff<TypeParam> * exact) << bend << ' ' << slope;
        }
}

}  // namespace
