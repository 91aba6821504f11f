#include "client/stream/camera_motion.h"

#include <numbers>

#include <gtest/gtest.h>

namespace terray::test {
namespace {

/// 100 m/s to the north-east and up, turning by 1 rad/s through north, tilting by -0.5 rad/s.
Camera flying(double seconds) {
    return {.position = {60 * seconds, 80 * seconds, 10 * seconds},
            .heading = Radians(2 * std::numbers::pi - 0.1 + seconds),
            .pitch = Radians(-0.5 * seconds)};
}

TEST(CameraMotion, GoesOnAsTheLastFifthOfASecond) {
    CameraMotion motion;
    for (int n = 0; n < 20; ++n) motion.observe({.position = {0, -7.0 * n, 0}}, 0.05 * n - 1);  // before: elsewhere
    for (int n = 0; n < 30; ++n) motion.observe(flying(0.03 * n + 0.001 * (n % 3)), 0.03 * n + 0.001 * (n % 3));
    const double now = 0.03 * 29 + 0.001 * (29 % 3);
    for (const double ahead : {0.0, 0.4, 1.0}) {
        const auto camera = motion.ahead(ahead);
        ASSERT_TRUE(camera);
        const Camera expected = flying(now + ahead);
        EXPECT_NEAR(camera->position.x, expected.position.x, 1e-9);
        EXPECT_NEAR(camera->position.y, expected.position.y, 1e-9);
        EXPECT_NEAR(camera->position.z, expected.position.z, 1e-9);
        EXPECT_NEAR(std::remainder(camera->heading.value() - expected.heading.value(), 2 * std::numbers::pi), 0, 1e-9);
        EXPECT_NEAR(camera->pitch.value(), expected.pitch.value(), 1e-9);
    }
}

TEST(CameraMotion, TurnsTheShorterWayAndNoFartherThanStraightDown) {
    CameraMotion motion;
    motion.observe({.heading = Radians(6.2), .pitch = Radians(-1.2)}, 0);
    motion.observe({.heading = Radians(0.1), .pitch = Radians(-1.4)}, 0.1);
    const auto camera = motion.ahead(1);
    ASSERT_TRUE(camera);
    EXPECT_NEAR(camera->heading.value(), 0.1 + 10 * (2 * std::numbers::pi - 6.1), 1e-9);
    EXPECT_DOUBLE_EQ(camera->pitch.value(), -std::numbers::pi / 2);
}

TEST(CameraMotion, KnowsNothingOfACameraThatRestsOrWasSeenOnce) {
    CameraMotion motion;
    EXPECT_FALSE(motion.ahead(1));
    motion.observe(flying(0), 0);
    EXPECT_FALSE(motion.ahead(1));
    motion.observe(flying(1), 0);
    EXPECT_FALSE(motion.ahead(1)) << "no time has passed";
    for (int n = 1; n < 20; ++n) motion.observe(flying(1), 0.05 * n);
    EXPECT_FALSE(motion.ahead(1));
}

}  // namespace
}  // namespace terray::test
