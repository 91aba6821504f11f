#include "client/navigation/fly_to.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/common/random.h"
#include "tests/navigation/hills.h"

namespace terray::test {
namespace {

Camera somewhere(Random& random, const Hills& hills) {
    Camera camera{.position = {random.between(0, 20000), random.between(0, 20000), 0},
                  .heading = Radians(random.between(0, 6.28)),
                  .pitch = Radians(random.between(-1.5, 0.5))};
    camera.position.z = hills.heightAt(glm::dvec2(camera.position)) + random.between(2, 3000);
    return camera;
}

TEST(FlyTo, GoesFromTheOneCameraToTheOtherExactly) {
    Hills hills;
    Random random(1);
    const Camera from = somewhere(random, hills), to = somewhere(random, hills);
    const FlyTo path(from, to, hills, Metres(1.7));
    EXPECT_EQ(path.at(path.seconds()), to);
    EXPECT_EQ(path.at(path.seconds() + 9), to);
    EXPECT_EQ(path.at(0).position, from.position);
    EXPECT_GE(path.seconds(), 1.2);
    EXPECT_LE(path.seconds(), 5);
}

TEST(FlyTo, StaysAboveTheGroundBetween) {
    Hills hills;
    Random random(2);
    for (int n = 0; n < 200; ++n) {
        const FlyTo path(somewhere(random, hills), somewhere(random, hills), hills, Metres(1.7));
        for (double share = 1.0 / 16; share <= 15.0 / 16; share += 0.01) {
            const glm::dvec3 place = path.at(share * path.seconds()).position;
            EXPECT_GT(place.z, hills.heightAt(glm::dvec2(place)));
        }
    }
}

TEST(FlyTo, IsSmooth) {
    Hills hills;
    Random random(3);
    for (int n = 0; n < 50; ++n) {
        const FlyTo path(somewhere(random, hills), somewhere(random, hills), hills, Metres(1.7));
        constexpr double kStep = 1e-3;
        const auto velocity = [&](double seconds) {
            return (path.at(seconds + kStep).position - path.at(seconds).position) / kStep;
        };
        double fastest = 0;
        for (double t = 0; t < path.seconds(); t += 0.01) fastest = std::max(fastest, glm::length(velocity(t)));
        EXPECT_LT(glm::length(velocity(0)), 0.02 * fastest) << "it starts at rest";
        EXPECT_LT(glm::length(velocity(path.seconds() - kStep)), 0.02 * fastest) << "it ends at rest";
        for (double t = 0; t < path.seconds() - 0.01; t += 0.01)
            EXPECT_LT(glm::length(velocity(t + 0.01) - velocity(t)), 0.12 * fastest) << "no jerk at " << t;
    }
}

TEST(FlyTo, TurnsTheShorterWay) {
    Hills hills(0);
    const Camera from{.position = {0, 0, 100}, .heading = radiansFromDegrees(350)};
    const Camera to{.position = {1000, 0, 100}, .heading = radiansFromDegrees(10)};
    const FlyTo path(from, to, hills, Metres(1.7));
    for (double share = 0; share < 1; share += 0.1)
        EXPECT_LE(std::abs(std::remainder(degreesFromRadians(path.at(share * path.seconds()).heading), 360)), 10.001);
}

}  // namespace
}  // namespace terray::test
