// The grounds that a slack allows: every displaced ground is met between the grown and the shrunk one.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "common/reference/ground_caster.h"
#include "tests/reference/formula_heights.h"

namespace terray {
namespace {

using test::FormulaHeights;
using test::kNoGround;

constexpr Tiling kTiling{.west = 0, .north = 0, .finestSpacing = 1, .finestLevel = 0};
constexpr double kFloor = -1e6;

/// Rough ground of 60 samples a side with holes.
FormulaHeights roughGround() {
    return {{60, 60}, [](int64_t column, int64_t row) {
                std::mt19937 random(static_cast<uint32_t>(column * 1000 + row));
                std::uniform_real_distribution<double> uniform(0, 1);
                return uniform(random) < 0.1 ? kNoGround : 6 * uniform(random);
            }};
}

/// A ray across the ground, level or steep, over a flat or a curved earth.
template <class Check>
void forRandomRays(int count, const Check& check) {
    std::mt19937 random(5);  // NOLINT(cert-msc51-cpp): the same rays in every run
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    for (int n = 0; n < count; ++n) {
        View view;
        view.eye = {uniform(-10, 70), uniform(-70, 10), uniform(1, 20)};
        if (n % 3 == 0) view.earth = EarthCurvature{0.001, 0, 0.001};
        const glm::dvec3 aim(uniform(0, 60), uniform(-60, 0), uniform(0, 7));
        check(view, (aim - view.eye) / 40.0, uniform);
    }
}

TEST(ExtremeGround, WithoutSlackIsTheGround) {
    const FormulaHeights heights = roughGround();
    const GroundCaster caster(heights, kTiling, kFloor);
    int met = 0;
    forRandomRays(3000, [&](const View& view, const glm::dvec3& direction, auto) {
        const auto truth = caster.meet(view, direction);
        for (const Extreme extreme : {Extreme::grown, Extreme::shrunk}) {
            const auto found = caster.meetExtreme(view, direction, {}, extreme, kFloor);
            ASSERT_EQ(found.has_value(), truth.has_value());
            if (truth) {
                EXPECT_NEAR(*found, *truth, 1e-9);
            }
        }
        met += truth ? 1 : 0;
    });
    EXPECT_GT(met, 1000);
}

TEST(ExtremeGround, EveryDisplacedRayMeetsBetweenTheExtremes) {
    const FormulaHeights heights = roughGround();
    const GroundCaster caster(heights, kTiling, kFloor);
    const Slack slack{.height = {0.05, 0.01}, .heightBend = 1e-4, .reach = {0.03, 0.002}, .edge = {0.03, 0.002}};
    int between = 0, apart = 0;
    forRandomRays(3000, [&](const View& view, const glm::dvec3& direction, auto uniform) {
        const auto grown = caster.meetExtreme(view, direction, slack, Extreme::grown, kFloor);
        const auto shrunk = caster.meetExtreme(view, direction, slack, Extreme::shrunk, kFloor);
        for (int n = 0; n < 10; ++n) {
            const double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
            View displaced = view;
            displaced.eye += glm::dvec3(x * slack.reach.a, y * slack.reach.a, z * slack.height.a);
            const glm::dvec3 turned = direction + glm::dvec3(x * slack.reach.b, y * slack.reach.b, z * slack.height.b);
            const auto found = caster.meet(displaced, turned);
            if (found) {
                ASSERT_TRUE(grown);
                EXPECT_GE(*found, *grown);
            }
            if (shrunk) {
                ASSERT_TRUE(found);
                EXPECT_LE(*found, *shrunk);
            }
            between += found && shrunk ? 1 : 0;
            apart += found && *found > *grown ? 1 : 0;
        }
    });
    EXPECT_GT(between, 3000);
    EXPECT_GT(apart, 3000);
}

TEST(ExtremeGround, OnASlopeIsOffByTheSlack) {
    // Ground at 0.5 x: higher by the height's slack and half the reach.
    const FormulaHeights heights({60, 60},
                                 [](int64_t column, int64_t) { return 0.5 * (static_cast<double>(column) + 0.5); });
    const GroundCaster caster(heights, kTiling, kFloor);
    const Slack slack{.height = {0.1, 0}, .reach = {0.2, 0}};
    View view;
    view.eye = {30, -30, 100};
    for (const auto& [extreme, height] : {std::pair(Extreme::grown, 15.2), std::pair(Extreme::shrunk, 14.8)})
        EXPECT_NEAR(caster.meetExtreme(view, {0, 0, -1}, slack, extreme, kFloor).value(), 100 - height, 1e-9);
}

TEST(ExtremeGround, EndsByTheSlackFartherOutOrIn) {
    const FormulaHeights heights({60, 60}, [](int64_t, int64_t) { return 5.0; });
    const GroundCaster caster(heights, kTiling, kFloor);
    const Slack slack{.edge = {0.1, 0}};
    const auto meets = [&](double x, Extreme extreme) {
        View view;
        view.eye = {x, -30, 100};
        return caster.meetExtreme(view, {0, 0, -1}, slack, extreme, kFloor).has_value();
    };
    EXPECT_TRUE(meets(-0.09, Extreme::grown));
    EXPECT_FALSE(meets(-0.11, Extreme::grown));
    EXPECT_TRUE(meets(60.09, Extreme::grown));
    EXPECT_FALSE(meets(0.09, Extreme::shrunk));
    EXPECT_TRUE(meets(0.11, Extreme::shrunk));
    EXPECT_FALSE(meets(59.91, Extreme::shrunk));
}

}  // namespace
}  // namespace terray
