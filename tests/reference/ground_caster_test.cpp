// The reference against closed forms: what a ray meets is known by a formula, not by another walk.
#include "common/reference/ground_caster.h"

#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/reference/formula_heights.h"

namespace terray {
namespace {

using test::FormulaHeights;
using test::kNoGround;

constexpr double kNoFloor = -1e9;
/// Samples of 3 m, their upper-left corner away from 0.
constexpr Tiling kTiling{.west = 5000, .north = 90000, .finestSpacing = 3, .finestLevel = 1};
constexpr GridSize kSize{700, 620};

glm::dvec2 placeOf(double column, double row) {
    return {kTiling.west + (column + 0.5) * 3, kTiling.north - (row + 0.5) * 3};
}
FormulaHeights heightsOf(const std::function<double(double x, double y)>& formula) {
    return {kSize, [formula](int64_t column, int64_t row) {
                const glm::dvec2 at = placeOf(static_cast<double>(column), static_cast<double>(row));
                return formula(at.x, at.y);
            }};
}
const glm::dvec2 kMiddle = placeOf(349.5, 309.5);

/// Rays from a shell of eyes around the middle, aimed at ground inside.
template <class Check>
void forRandomRays(int count, double above, const Check& check) {
    std::mt19937 random(11);  // NOLINT(cert-msc51-cpp): the same rays in every run
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    for (int n = 0; n < count; ++n) {
        View view;
        view.eye = {kMiddle.x + uniform(-1200, 1200), kMiddle.y + uniform(-1200, 1200), above + uniform(0, 600)};
        const glm::dvec3 aim(kMiddle.x + uniform(-700, 700), kMiddle.y + uniform(-700, 700), uniform(-100, 100));
        check(view, (aim - view.eye) / uniform(100, 1000));
    }
}
bool inside(const glm::dvec3& place) {
    return std::abs(place.x - kMiddle.x) < 1045 && std::abs(place.y - kMiddle.y) < 925;
}

TEST(GroundCaster, MeetsATiltedPlaneWhereTheFormulaSays) {
    const auto plane = [](double x, double y) { return 40 + 0.21 * (x - kMiddle.x) - 0.13 * (y - kMiddle.y); };
    const FormulaHeights heights = heightsOf(plane);
    const GroundCaster caster(heights, kTiling, kNoFloor);
    int met = 0;
    forRandomRays(2000, 700, [&](const View& view, const glm::dvec3& direction) {
        const double clearance = view.eye.z - plane(view.eye.x, view.eye.y);
        const double rate = direction.z - 0.21 * direction.x + 0.13 * direction.y;
        const double expected = -clearance / rate;
        if (rate >= 0 || !inside(view.at(direction, expected))) return;
        const auto found = caster.meet(view, direction);
        ASSERT_TRUE(found);
        if (*found < expected * 0.999) return;  // through the ground's side
        EXPECT_NEAR(*found, expected, 1e-9 * expected);
        ++met;
    });
    EXPECT_GT(met, 1000);
}

TEST(GroundCaster, MeetsASaddleWhereTheFormulaSays) {
    // x times y is bilinear, so patches hold it exactly.
    constexpr double kTwist = 4e-4;
    const auto saddle = [](double x, double y) { return kTwist * (x - kMiddle.x) * (y - kMiddle.y); };
    const FormulaHeights heights = heightsOf(saddle);
    const GroundCaster caster(heights, kTiling, kNoFloor);
    int met = 0;
    forRandomRays(2000, 500, [&](const View& view, const glm::dvec3& d) {
        const glm::dvec3 e = view.eye - glm::dvec3(kMiddle, 0);
        const double a = -kTwist * d.x * d.y;
        const double b = d.z - kTwist * (e.x * d.y + e.y * d.x);
        const double c = e.z - kTwist * e.x * e.y;
        const double root = std::sqrt(b * b - 4 * a * c);
        if (!(c > 0) || std::isnan(root)) return;
        double first = 1e300;
        for (const double t : {(-b - root) / (2 * a), (-b + root) / (2 * a)})
            if (t > 0) first = std::min(first, t);
        if (first == 1e300 || !inside(view.at(d, first))) return;
        const auto found = caster.meet(view, d);
        ASSERT_TRUE(found);
        if (!inside(view.at(d, *found))) return;  // through the ground's side
        EXPECT_NEAR(*found, first, 1e-7 * first);
        ++met;
    });
    EXPECT_GT(met, 1000);
}

/// When a ray first meets the cone of a slope around the middle, with the apex at a height; or never.
std::optional<double> meetCone(const View& view, const glm::dvec3& d, double apex, double slope) {
    const glm::dvec3 e = view.eye - glm::dvec3(kMiddle, apex);
    const double k = slope * slope;
    const double a = d.z * d.z - k * (d.x * d.x + d.y * d.y);
    const double b = 2 * (e.z * d.z - k * (e.x * d.x + e.y * d.y));
    const double c = e.z * e.z - k * (e.x * e.x + e.y * e.y);
    const double root = std::sqrt(b * b - 4 * a * c);
    std::optional<double> first;
    for (const double t : {(-b - root) / (2 * a), (-b + root) / (2 * a)})
        if (t > 0 && e.z + t * d.z <= 0 && (!first || t < *first)) first = t;  // NaN never is
    return first;
}

TEST(GroundCaster, MeetsAConeBetweenTwoThatAreASagApart) {
    // Between samples s apart a patch lies below a cone's surface (concave along rings) by at most s^2 / 4 times the
    // greatest second derivative, slope / r, but at the apex, where it is cut by slope * s at most.
    constexpr double kSlope = 0.8, kApex = 300;
    const FormulaHeights heights =
        heightsOf([](double x, double y) { return kApex - kSlope * std::hypot(x - kMiddle.x, y - kMiddle.y); });
    const GroundCaster caster(heights, kTiling, kNoFloor);
    int met = 0;
    forRandomRays(2000, 500, [&](const View& view, const glm::dvec3& d) {
        const auto outer = meetCone(view, d, kApex + 1e-9, kSlope);
        const auto found = caster.meet(view, d);
        if (!found || !inside(view.at(d, *found))) return;
        const glm::dvec3 at = view.at(d, *found);
        const double radius = std::hypot(at.x - kMiddle.x, at.y - kMiddle.y);
        const double sag = radius > 30 ? 9.0 / 4 * kSlope / (radius - 5) : kSlope * 3;
        const double cone = kApex - kSlope * radius;
        EXPECT_LE(at.z, cone + 1e-6);
        EXPECT_GE(at.z, cone - sag - 1e-6) << radius;
        ASSERT_TRUE(outer);
        EXPECT_GE(*found, *outer - 1e-9 * *outer);
        const auto inner = meetCone(view, d, kApex - kSlope * 3, kSlope);  // deeper than any sag
        if (inner) {
            EXPECT_LE(*found, *inner);
        }
        ++met;
    });
    EXPECT_GT(met, 1000);
}

TEST(GroundCaster, MeetsASphereCapWithinItsSag) {
    // A cap of radius R around a centre below: second derivatives are at most R^2 / z^3 of the height z over the
    // centre.
    constexpr double kRadius = 4000, kDepth = 3600;
    const FormulaHeights heights = heightsOf([](double x, double y) {
        const double across = std::hypot(x - kMiddle.x, y - kMiddle.y);
        return std::sqrt(kRadius * kRadius - across * across) - kDepth;
    });
    const GroundCaster caster(heights, kTiling, kNoFloor);
    constexpr double kLeastZ = 3660;  // at the corners, 1400 m from the middle: sqrt(4000^2 - 1400^2) = 3747
    constexpr double kSag = 9.0 / 4 * kRadius * kRadius / (kLeastZ * kLeastZ * kLeastZ);
    int met = 0;
    forRandomRays(2000, 700, [&](const View& view, const glm::dvec3& d) {
        const glm::dvec3 e = view.eye - glm::dvec3(kMiddle, -kDepth);
        const auto meetSphere = [&](double radius) {
            const double a = glm::dot(d, d), b = glm::dot(e, d), c = glm::dot(e, e) - radius * radius;
            return (-b - std::sqrt(b * b - a * c)) / a;  // NaN: missed
        };
        const auto found = caster.meet(view, d);
        const double outer = meetSphere(kRadius);
        const double inner = meetSphere(kRadius - kSag);
        const bool missed = std::isnan(outer);
        EXPECT_FALSE(missed && found && inside(view.at(d, *found)));
        if (std::isnan(inner) || !inside(view.at(d, inner)) || !inside(view.at(d, outer))) return;
        ASSERT_TRUE(found);
        EXPECT_GE(*found, outer * (1 - 1e-12));
        EXPECT_LE(*found, inner);
        ++met;
    });
    EXPECT_GT(met, 1000);
}

TEST(GroundCaster, BendsRaysOverACurvedEarth) {
    // Flat ground at 0, an eye at height h: h + z t + (form) t^2 = 0.
    const FormulaHeights heights = heightsOf([](double, double) { return 0.0; });
    const GroundCaster caster(heights, kTiling, kNoFloor);
    int met = 0, cleared = 0;
    forRandomRays(2000, 10, [&](View view, const glm::dvec3& direction) {
        view.earth = EarthCurvature{1e-4, 3e-5, 2e-4};
        const double bend = view.earth->drop(direction.x, direction.y);
        const double root = std::sqrt(direction.z * direction.z - 4 * bend * view.eye.z);
        const double expected = 2 * view.eye.z / (-direction.z + root);
        const auto found = caster.meet(view, direction);
        if (std::isnan(root)) {
            EXPECT_FALSE(found);
            ++cleared;
        } else if (direction.z < 0 && inside(view.eye + expected * direction)) {
            ASSERT_TRUE(found);
            EXPECT_NEAR(*found, expected, 1e-7 * expected);
            ++met;
        }
    });
    EXPECT_GT(met, 300);
    EXPECT_GT(cleared, 300);
}

TEST(GroundCaster, ExaggeratedIsTheHigherGround) {
    const auto hills = [](double x, double y) { return 40 * std::sin(x / 90) * std::cos(y / 70); };
    const FormulaHeights low = heightsOf(hills);
    const FormulaHeights high = heightsOf([&](double x, double y) { return 8 * hills(x, y); });
    const GroundCaster lowCaster(low, kTiling, kNoFloor);
    const GroundCaster highCaster(high, kTiling, kNoFloor);
    forRandomRays(500, 400, [&](const View& view, const glm::dvec3& direction) {
        View multiplied = view;
        multiplied.exaggeration = 8;
        EXPECT_EQ(lowCaster.meet(multiplied, direction), highCaster.meet(view, direction));
    });
}

TEST(GroundCaster, RaysStraightDownMeetTheHeightBelow) {
    const FormulaHeights heights = heightsOf([](double x, double y) { return 0.3 * x - 0.2 * y + 17000; });
    const GroundCaster caster(heights, kTiling, kNoFloor);
    for (const glm::dvec3 direction : {glm::dvec3(0, 0, -2), glm::dvec3(-0.0, 5e-324, -2)}) {
        View view;
        view.eye = {kMiddle.x + 1.1, kMiddle.y - 0.7, 90000};
        const double ground = 0.3 * view.eye.x - 0.2 * view.eye.y + 17000;
        EXPECT_NEAR(caster.meet(view, direction).value(), (90000 - ground) / 2, 1e-8);
        EXPECT_NEAR(caster.heightAt(view.eye.x, view.eye.y).value(), ground, 1e-9);
        view.eye.x = kTiling.west - 1;
        EXPECT_FALSE(caster.meet(view, direction));
        EXPECT_FALSE(caster.heightAt(view.eye.x, view.eye.y));
    }
}

TEST(GroundCaster, TheGroundIsSolidAndEndsAtItsFloor) {
    const FormulaHeights heights = heightsOf([](double, double) { return 50.0; });
    const GroundCaster caster(heights, kTiling, -20);
    View view;
    view.eye = {kMiddle.x, kMiddle.y, 30};
    EXPECT_EQ(caster.meet(view, {1, 0, 0.1}), 0.0) << "an eye in the ground";
    view.eye.z = -30;
    EXPECT_EQ(caster.meet(view, {0, 0, 1}), 10.0) << "from below up to the floor";
    EXPECT_FALSE(caster.meet(view, {1, 0, -0.1})) << "below, and down";
    view.eye = {kTiling.west - 100, kMiddle.y, 0};
    EXPECT_NEAR(caster.meet(view, {1, 0, 0}).value(), 100, 1e-9) << "the ground's side";
    view.eye.z = -20.5;
    EXPECT_FALSE(caster.meet(view, {1, 0, 0})) << "under it";
    view.eye.z = 51;
    EXPECT_FALSE(caster.meet(view, {1, 0, 0})) << "over it";
}

TEST(GroundCaster, RaysInThePlaneOfFlatGroundEndAtItsRim) {
    const FormulaHeights heights = heightsOf([](double, double) { return 50.0; });
    const GroundCaster caster(heights, kTiling, kNoFloor);
    View view;
    view.eye = {kTiling.west - 100, kMiddle.y, 50};
    EXPECT_NEAR(caster.meet(view, {1, 0, 0}).value(), 100, 1e-9);
}

TEST(GroundCaster, AQuarterWithoutSampleIsOpen) {
    const FormulaHeights heights(kSize, [](int64_t column, int64_t row) {
        return column == 100 && row == 80 ? kNoGround : 10.0 + (column == 101 ? 8 : 0);
    });
    const GroundCaster caster(heights, kTiling, -100);
    const auto below = [&](double column, double row) {
        View view;
        const glm::dvec2 at = placeOf(column, row);
        view.eye = {at.x, at.y, 1000};
        const auto t = caster.meet(view, {0, 0, -1});
        EXPECT_EQ(t.has_value(), caster.heightAt(at.x, at.y).has_value());
        return t ? std::optional(1000 - *t) : std::nullopt;
    };
    EXPECT_FALSE(below(100, 80));
    EXPECT_FALSE(below(99.51, 80.49));
    EXPECT_FALSE(below(100.49, 79.51));
    EXPECT_NEAR(below(99.49, 80).value(), 10, 1e-9);
    // The patch east of the hole: 18 to the east, the missing corner at the mean of 10, 18 and 18.
    EXPECT_NEAR(below(100.51, 80).value(), 0.49 * 46 / 3 + 0.51 * 18, 1e-9);
}

TEST(GroundCaster, DatasetsOfOneSampleOneRowAndOneColumnAreGround) {
    for (const GridSize size : {GridSize{1, 1}, GridSize{40, 1}, GridSize{1, 40}}) {
        const FormulaHeights heights(size, [](int64_t, int64_t) { return 7.0; });
        const GroundCaster caster(heights, kTiling, -100);
        View view;
        view.eye = {kTiling.west + 0.1, kTiling.north - 2.9, 47};
        EXPECT_NEAR(caster.meet(view, {0, 0, -1}).value(), 40, 1e-12);
        view.eye.x = kTiling.west + static_cast<double>(size.width) * 3 + 0.1;
        EXPECT_FALSE(caster.meet(view, {0, 0, -1}));
    }
}

}  // namespace
}  // namespace terray
