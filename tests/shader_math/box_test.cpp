// shaders/math/box.glsl against closed forms: where a ray enters and leaves a box.

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "shaders/math/math.h"
#include "tests/shader_math/both.h"

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

template <class Math>
class Box : public testing::Test {
  protected:
    static auto interval(typename Math::vec3 eye, typename Math::vec3 direction) {
        return Math::boxInterval(eye, terray::test::inverseOf<Math>(direction), {1, 2, 3}, {5, 10, 11});
    }
};
TYPED_TEST_SUITE(Box, terray::test::Precisions, terray::test::PrecisionNames);

TYPED_TEST(Box, IsEnteredAndLeftByRaysAlongEachAxisBothWays) {
    using vec3 = typename TypeParam::vec3;
    const vec3 low(1, 2, 3);
    const vec3 high(5, 10, 11);
    for (int axis = 0; axis < 3; ++axis) {
        vec3 eye(3, 4, 5);
        vec3 direction(0);
        eye[axis] = low[axis] - 8;
        direction[axis] = 2;
        const auto forward = this->interval(eye, direction);
        EXPECT_EQ(forward.enter, 4) << axis;
        EXPECT_EQ(forward.exit, 4 + (high[axis] - low[axis]) / 2) << axis;
        eye[axis] = high[axis] + 8;
        direction[axis] = -2;
        const auto back = this->interval(eye, direction);
        EXPECT_EQ(back.enter, 4) << axis;
        EXPECT_EQ(back.exit, forward.exit) << axis;
    }
}

TYPED_TEST(Box, IsTouchedAtACornerAndAlongAnEdgeButNotBeside) {
    using real = typename TypeParam::real;
    // Diagonally through the corners (1, 2, 3) and, past them, out of a face.
    const auto through = this->interval({-1, 0, 1}, {1, 1, 1});
    EXPECT_EQ(through.enter, 2);
    EXPECT_EQ(through.exit, 6);
    // The one point (5, 2, 3): two slabs are entered where the third is left.
    const auto corner = this->interval({7, 0, 1}, {-1, 1, 1});
    EXPECT_EQ(corner.enter, 2);
    const auto onlyPoint = this->interval({3, 0, 1}, {1, 1, 1});
    EXPECT_EQ(onlyPoint.enter, 2);
    EXPECT_EQ(onlyPoint.exit, 2);
    const auto past = this->interval({real(3.0078125), 0, 1}, {1, 1, 1});
    EXPECT_LT(past.exit, past.enter);
    // Within a face or along an edge: the lower ones are the box's, the upper ones the next box's, so that such a ray
    // is in one of two neighbours and in no two. Zeros of either sign.
    for (const real zero : {real{0}, -real{0}}) {
        const auto edge = this->interval({0, 2, 3}, {1, zero, zero});
        EXPECT_EQ(edge.enter, 1);
        EXPECT_EQ(edge.exit, 5);
        const auto upper = this->interval({0, 4, 11}, {1, zero, zero});
        EXPECT_LT(upper.exit, upper.enter);
    }
}

TYPED_TEST(Box, OfNoVolumeAndOfAnyDistanceNeverAnswersNotANumber) {
    using real = typename TypeParam::real;
    using vec3 = typename TypeParam::vec3;
    const real far = real(1e9);  // times the inverse of 0 this overflows a float
    for (const real x : {-far, real{0}, far})
        for (const real z : {-far, real{0}, far})
            for (const vec3 direction : {vec3(0, 0, 1), vec3(1, 0, 0), vec3(0, 0, 0), vec3(real(1e-38), 1, -1)}) {
                const auto flat = TypeParam::boxInterval({x, 0, z}, terray::test::inverseOf<TypeParam>(direction),
                                                         {0, 0, 0}, {512, 512, 0});
                EXPECT_FALSE(std::isnan(flat.enter) || std::isnan(flat.exit)) << x << ' ' << z;
                EXPECT_GE(flat.enter, 0);
            }
}

}  // namespace
