#include "client/navigation/navigator.h"

#include <limits>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "client/navigation/grab.h"
#include "tests/common/random.h"
#include "tests/navigation/hills.h"

namespace terray::test {
namespace {

const Camera kStart{.position = {5000, 5000, 3000}, .heading = Radians(0.7), .pitch = Radians(-0.5)};

bool finite(const Camera& camera) {
    return std::isfinite(glm::dot(camera.position, glm::dvec3(1))) && std::isfinite(camera.heading.value()) &&
           std::isfinite(camera.pitch.value()) && std::isfinite(camera.verticalFov.value());
}

/// Where a flight of 3 seconds ends that is drawn so many times a second: held keys, then momentum.
Camera flown(int framesPerSecond, double hillHeight) {
    Hills hills(hillHeight);
    Navigator navigator(sceneOver(hills), kStart);
    for (int frame = 0; frame < 3 * framesPerSecond; ++frame) {
        const bool held = frame < 2 * framesPerSecond;
        navigator.step({.right = held ? 0.3 : 0.0, .ahead = held ? 1.0 : 0.0}, 1.0 / framesPerSecond);
    }
    return navigator.camera();
}

TEST(Navigator, MomentumDoesNotDependOnTheFrameRate) {
    for (const double hillHeight : {0.0, 500.0}) {
        const glm::dvec3 smooth = flown(240, hillHeight).position;
        const double way = glm::distance(smooth, kStart.position);
        EXPECT_GT(way, 1000);
        for (const int rate : {4, 10, 30, 60, 144})
            EXPECT_LT(glm::distance(flown(rate, hillHeight).position, smooth), 0.003 * way) << rate << " Hz";
    }
}

TEST(Navigator, SpeedScalesWithTheHeightOverGround) {
    Hills level(0);
    const auto way = [&](double height) {
        Navigator navigator(sceneOver(level), {.position = {0, 0, height}});
        for (int n = 0; n < 60; ++n) navigator.step({.ahead = 1}, 1.0 / 60);
        return navigator.camera().position.y;
    };
    EXPECT_NEAR(way(2000) / way(100), 20, 1e-6);
    Navigator faster(sceneOver(level), {.position = {0, 0, 100}});
    faster.scaleSpeed(2);
    for (int n = 0; n < 60; ++n) faster.step({.ahead = 1, .fast = true}, 1.0 / 60);
    EXPECT_NEAR(faster.camera().position.y / way(100), 2 * Navigator::kFast, 1e-6);
}

TEST(Navigator, ComesToRestAndSaysSo) {
    Hills hills;
    Navigator navigator(sceneOver(hills), kStart);
    EXPECT_FALSE(navigator.moving());
    navigator.step({.ahead = 1}, 0.2);
    EXPECT_TRUE(navigator.moving());
    for (int n = 0; n < 40; ++n) navigator.step({}, 0.1);
    EXPECT_FALSE(navigator.moving());
    const Camera rested = navigator.camera();
    navigator.step({}, 0.1);
    EXPECT_EQ(navigator.camera(), rested);
}

TEST(Navigator, WalksAtEyeHeight) {
    Hills hills;
    Navigator navigator(sceneOver(hills), kStart);
    navigator.setMode(NavigationMode::walk);
    for (int n = 0; n < 600; ++n) {
        navigator.step({.ahead = 1, .fast = true}, 1.0 / 60);
        const glm::dvec3 eye = navigator.camera().position;
        // The hills rise by at most 0.9 m within the metre that is looked at around the eye.
        EXPECT_NEAR(eye.z, hills.heightAt(glm::dvec2(eye)) + Navigator::kEyeHeight, 0.9);
    }
}

TEST(Navigator, MapLooksStraightDownAndAPannedPointStaysUnderTheCursor) {
    Hills hills;
    Navigator navigator(sceneOver(hills), kStart);
    navigator.setMode(NavigationMode::map);
    navigator.turn(Radians(0.3), Radians(0.3));
    EXPECT_NEAR(degreesFromRadians(navigator.camera().pitch), -90, 1e-12);
    const glm::dvec3 point(5100, 5200, 700);
    navigator.grab(point);
    navigator.dragTo({100, 300});
    const auto pixel = pixelOf(drawn(navigator.camera()), point);
    ASSERT_TRUE(pixel.has_value());
    EXPECT_LT(glm::distance(*pixel, glm::dvec2(100, 300)), 1e-6);
}

TEST(Navigator, OrbitKeepsTheGrabbedPointUnderTheCursor) {
    Hills hills;
    Navigator navigator(sceneOver(hills, 2), kStart);
    navigator.setMode(NavigationMode::orbit);
    const glm::dvec3 point(6500, 6500, 1200);
    const auto before = pixelOf(drawn(navigator.camera(), 2), point);
    ASSERT_TRUE(before.has_value());
    navigator.grab(point);
    for (int n = 0; n < 30; ++n) {
        navigator.orbit(Radians(0.05), Radians(-0.01));
        const auto after = pixelOf(drawn(navigator.camera(), 2), point);
        ASSERT_TRUE(after.has_value());
        EXPECT_LT(glm::distance(*before, *after), 1e-6);
    }
}

TEST(Navigator, DoubleClickEndsNearThePointLookingAtIt) {
    Hills hills;
    Navigator navigator(sceneOver(hills), kStart);
    const glm::dvec3 point(9000, 8000, hills.heightAt({9000, 8000}));
    const double before = glm::distance(kStart.position, point);
    navigator.flyToLookAt(point);
    for (int n = 0; n < 600 && navigator.flying(); ++n) navigator.step({}, 1.0 / 60);
    EXPECT_FALSE(navigator.flying());
    EXPECT_LT(glm::distance(navigator.camera().position, point), 0.3 * before);
    const auto pixel = pixelOf(drawn(navigator.camera()), point);
    ASSERT_TRUE(pixel.has_value());
    EXPECT_LT(glm::distance(*pixel, glm::dvec2(320, 240)), 40) << "the ground may lift the eye a little";
}

TEST(Navigator, AKeyEndsAFlight) {
    Hills hills;
    Navigator navigator(sceneOver(hills), kStart);
    navigator.flyTo({.position = {15000, 15000, 5000}});
    navigator.step({}, 0.5);
    EXPECT_TRUE(navigator.flying());
    navigator.step({.ahead = 1}, 0.1);
    EXPECT_FALSE(navigator.flying());
}

/// Ground known coarsely in the east: it may be higher there than told.
class HalfKnown final : public Ground {
  public:
    [[nodiscard]] std::optional<GroundHeight> under(glm::dvec2 place) override {
        return GroundHeight{100, place.x > 1000 ? 50.0 : 0.0};
    }
};

TEST(Navigator, KeepsAboveWhatTheGroundMayBeWhenItMovesButNotWhenItWasPlaced) {
    HalfKnown ground;
    Navigator navigator(sceneOver(ground), {.position = {2000, 0, 110}});
    EXPECT_EQ(navigator.camera().position.z, 110);
    navigator.step({}, 1);
    EXPECT_EQ(navigator.camera().position.z, 110);
    navigator.step({.right = 1}, 0.1);
    EXPECT_GE(navigator.camera().position.z, 150);
    navigator.place({.position = {2000, 0, 50}});
    EXPECT_NEAR(navigator.camera().position.z, 100 + Navigator::kEyeHeight, 1e-9);
}

/// A number as a broken driver may send it, or a common one.
double wild(Random& random, double range) {
    switch (random.below(20)) {
        case 0:
            return std::numeric_limits<double>::quiet_NaN();
        case 1:
            return std::numeric_limits<double>::infinity();
        case 2:
            return -1e300;
        default:
            return random.between(-range, range);
    }
}

void anything(Navigator& navigator, Random& random) {
    const auto point = [&] { return glm::dvec3(wild(random, 2e4), wild(random, 2e4), wild(random, 2e3)); };
    switch (random.below(12)) {
        case 0:
            navigator.setMode(static_cast<NavigationMode>(random.below(4)));
            break;
        case 1:
            navigator.turn(Radians(wild(random, 1)), Radians(wild(random, 1)));
            break;
        case 2:
            navigator.grab(point());
            break;
        case 3:
            navigator.dragTo({wild(random, 640), wild(random, 480)});
            break;
        case 4:
            navigator.orbit(Radians(wild(random, 1)), Radians(wild(random, 1)));
            break;
        case 5:
            navigator.zoom(point(), wild(random, 3));
            break;
        case 6:
            navigator.flyToLookAt(point());
            break;
        case 7:
            navigator.flyTo({.position = point(), .heading = Radians(wild(random, 7))});
            break;
        case 8:
            navigator.scaleSpeed(wild(random, 3));
            break;
        case 9:
            navigator.place({.position = point()});
            break;
        case 10:
            navigator.setFieldOfView(Radians(wild(random, 4)));
            break;
        default:
            navigator.release();
            break;
    }
}

TEST(Navigator, RandomInputNeverGetsUnderGroundNorAwayNorToNonsense) {
    Hills hills;
    Random random(4);
    Navigator navigator(sceneOver(hills, 1.7), kStart);
    for (int n = 0; n < 200000; ++n) {
        anything(navigator, random);
        navigator.step(
            {.right = wild(random, 1), .ahead = wild(random, 1), .up = wild(random, 1), .fast = random.below(2) == 0},
            wild(random, 0.05));
        const Camera& camera = navigator.camera();
        ASSERT_TRUE(finite(camera)) << n;
        ASSERT_GE(camera.position.z, hills.heightAt(glm::dvec2(camera.position)) + Navigator::kEyeHeight - 1e-9) << n;
        // Four diagonals of 28.3 km from the dataset at most.
        ASSERT_LT(std::max(std::abs(camera.position.x), std::abs(camera.position.y)), 1.332e5) << n;
        ASSERT_LE(std::abs(camera.pitch.value()), 1.5707963267948966) << n;
    }
}

}  // namespace
}  // namespace terray::test
