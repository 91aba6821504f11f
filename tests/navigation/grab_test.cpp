#include "client/navigation/grab.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/common/random.h"
#include "tests/navigation/hills.h"

namespace terray::test {
namespace {

struct Case {
    View view;
    glm::dvec3 point;  ///< seen in the picture
    glm::dvec2 pixel;
};

/// A view from 100 to 5000 m, level to steep, over a flat earth or one that bends 1000 times as much as ours.
Case randomCase(Random& random, bool curved) {
    const Camera camera{.position = {random.between(-1e4, 1e4), random.between(-1e4, 1e4), random.between(100, 5000)},
                        .heading = Radians(random.between(0, 6.28)),
                        .pitch = Radians(random.between(-1.5, -0.2))};
    std::optional<EarthCurvature> earth;
    if (curved) earth = EarthCurvature{7e-5, 1e-5, 8e-5};
    Case found{
        .view = drawn(camera, 1.5, earth), .point = {}, .pixel = {random.between(0, 640), random.between(240, 480)}};
    found.point = found.view.at(found.view.direction(found.pixel.x, found.pixel.y), random.between(50, 8000));
    return found;
}

class Grab : public testing::TestWithParam<bool> {};

TEST_P(Grab, APointIsSeenAtThePixelWhoseRayMeetsIt) {
    Random random(1);
    for (int n = 0; n < 1000; ++n) {
        const Case one = randomCase(random, GetParam());
        const auto pixel = pixelOf(one.view, one.point);
        ASSERT_TRUE(pixel.has_value());
        EXPECT_LT(glm::distance(*pixel, one.pixel), 1e-6);
    }
}

TEST_P(Grab, ADraggedPointIsUnderTheCursorAndTheEyeKeepsItsHeight) {
    Random random(2);
    int moved = 0;
    for (int n = 0; n < 1000; ++n) {
        Case one = randomCase(random, GetParam());
        const glm::dvec2 cursor(random.between(0, 640), random.between(0, 480));
        const auto eye = eyeDragged(one.view, one.point, cursor);
        if (!eye) continue;  // at the horizon
        ++moved;
        EXPECT_EQ(eye->z, one.view.eye.z);
        one.view.eye = *eye;
        const auto pixel = pixelOf(one.view, one.point);
        ASSERT_TRUE(pixel.has_value());
        EXPECT_LT(glm::distance(*pixel, cursor), 1e-5);
    }
    EXPECT_GT(moved, 500);
}

TEST_P(Grab, APointKeepsItsPixelWhileTheViewTurnsAroundItOrComesNearer) {
    Random random(3);
    for (int n = 0; n < 1000; ++n) {
        const Case one = randomCase(random, GetParam());
        const Camera other{.heading = Radians(random.between(0, 6.28)), .pitch = Radians(random.between(-1.5, 1.5))};
        View turned = drawn(other);
        turned.earth = one.view.earth;
        turned.eye = eyeOrbited(one.view, turned, one.point);
        View nearer = one.view;
        nearer.eye = eyeZoomed(one.view, one.point, random.between(0.1, 3));
        for (const View& view : {turned, nearer}) {
            const auto pixel = pixelOf(view, one.point);
            ASSERT_TRUE(pixel.has_value());
            EXPECT_LT(glm::distance(*pixel, one.pixel), 1e-5);
        }
    }
}

TEST_P(Grab, AboveTheHorizonNothingIsDragged) {
    const View view =
        drawn({.position = {0, 0, 1000}}, 1, GetParam() ? std::optional(EarthCurvature{7e-8, 0, 7e-8}) : std::nullopt);
    EXPECT_FALSE(eyeDragged(view, {0, 1000, 0}, {320, 100}).has_value());
    EXPECT_FALSE(eyeDragged(view, {0, 1000, 0}, {320, 240}).has_value());
    EXPECT_TRUE(eyeDragged(view, {0, 1000, 0}, {320, 470}).has_value());
}

INSTANTIATE_TEST_SUITE_P(OverTheEarth, Grab, testing::Bool(),
                         [](const auto& run) { return run.param ? "Curved" : "Flat"; });

}  // namespace
}  // namespace terray::test
