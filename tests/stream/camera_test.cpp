#include "client/stream/camera.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace terray::test {
namespace {

void expectNear(const glm::dvec3& a, const glm::dvec3& b) {
    EXPECT_LT(glm::distance(a, b), 1e-12);
}

TEST(Camera, LooksNorthAlongTheYAxis) {
    const View view = viewOf({.position = {1, 2, 3}}, 200, 100);
    expectNear(view.eye, {1, 2, 3});
    expectNear(view.forward, {0, 1, 0});
    expectNear(view.right, {1, 0, 0});
    expectNear(view.up, {0, 0, 1});
    EXPECT_NEAR(view.tanHalfHeight, std::tan(0.125 * 3.141592653589793), 1e-15);
}

TEST(Camera, HeadingTurnsClockwiseAndPitchUp) {
    expectNear(viewOf({.heading = radiansFromDegrees(90)}, 1, 1).forward, {1, 0, 0});
    expectNear(viewOf({.heading = radiansFromDegrees(90)}, 1, 1).right, {0, -1, 0});
    const View up30 = viewOf({.heading = {}, .pitch = radiansFromDegrees(30)}, 1, 1);
    EXPECT_NEAR(up30.forward.z, 0.5, 1e-12);
}

TEST(Camera, StraightDownTheTopOfThePicturePointsToTheHeadingAndStraightUpAwayFromIt) {
    const Radians east = radiansFromDegrees(90);
    const View down = viewOf({.heading = east, .pitch = radiansFromDegrees(-90)}, 1, 1);
    expectNear(down.forward, {0, 0, -1});
    expectNear(down.up, {1, 0, 0});
    const View up = viewOf({.heading = east, .pitch = radiansFromDegrees(90)}, 1, 1);
    expectNear(up.forward, {0, 0, 1});
    expectNear(up.up, {-1, 0, 0});
}

TEST(Camera, AxesAreOrthonormalAndRightHandedInEveryDirection) {
    for (double heading = 0; heading < 360; heading += 17) {
        for (double pitch = -90; pitch <= 90; pitch += 15) {
            const View view =
                viewOf({.heading = radiansFromDegrees(heading), .pitch = radiansFromDegrees(pitch)}, 1, 1);
            EXPECT_NEAR(glm::length(view.up), 1, 1e-12);
            expectNear(glm::cross(view.right, view.up), -view.forward);
        }
    }
}

TEST(Camera, ReadsPlaneCoordinatesWithoutAProjection) {
    const auto camera = parseCamera("500000.5, 4649776,1234, -90,-12.5,60", nullptr);
    ASSERT_TRUE(camera.ok()) << camera.failure().message;
    expectNear(camera->position, {500000.5, 4649776, 1234});
    EXPECT_NEAR(degreesFromRadians(camera->heading), 270, 1e-12);
    EXPECT_NEAR(degreesFromRadians(camera->pitch), -12.5, 1e-12);
    EXPECT_NEAR(degreesFromRadians(camera->verticalFov), 60, 1e-12);
    EXPECT_EQ(parseCamera("0,0,0,0,0", nullptr)->verticalFov, Camera().verticalFov);
}

TEST(Camera, NamesTheCulpritOfATextThatIsNoCamera) {
    const auto why = [](const std::string& text) {
        const auto camera = parseCamera(text, nullptr);
        return camera.ok() ? "" : camera.failure().message;
    };
    EXPECT_NE(why("").find("expected x_m,y_m"), std::string::npos);
    EXPECT_NE(why("1,2,3,4").find("found 4 numbers"), std::string::npos);
    EXPECT_NE(why("1,2,3,4,5,6,7").find("found 7 numbers"), std::string::npos);
    EXPECT_NE(why("1,2,x,4,5").find("height is \"x\""), std::string::npos);
    EXPECT_NE(why("1,2,3 4,4,5").find("height is \"3 4\""), std::string::npos);
    EXPECT_NE(why("1,,3,4,5").find("y is \"\""), std::string::npos);
    EXPECT_NE(why("nan,2,3,4,5").find("x is \"nan\""), std::string::npos);
    EXPECT_NE(why("1,inf,3,4,5").find("y is \"inf\""), std::string::npos);
    EXPECT_NE(why("1,2,1e999,4,5").find("height is"), std::string::npos);
    EXPECT_NE(why("1,2,3,4,91").find("pitch is 91, expected -90 to 90 degrees"), std::string::npos);
    EXPECT_NE(why("1,2,3,361,0").find("heading is 361"), std::string::npos);
    EXPECT_NE(why("1,2,3,0,0,0").find("field of view is 0"), std::string::npos);
    EXPECT_NE(why("1,2,3,0,0,180").find("field of view is 180"), std::string::npos);
}

void expectRoundTrip(const Camera& camera, const Projection* projection) {
    const auto text = formatCamera(camera, projection);
    ASSERT_TRUE(text.ok()) << text.failure().message;
    const auto back = parseCamera(*text, projection);
    ASSERT_TRUE(back.ok()) << back.failure().message;
    EXPECT_LT(glm::distance(back->position, camera.position), 1e-3) << *text;
    EXPECT_LT(std::abs(std::remainder(degreesFromRadians(back->heading - camera.heading), 360)), 1e-6) << *text;
    EXPECT_NEAR(degreesFromRadians(back->pitch), degreesFromRadians(camera.pitch), 1e-6);
    EXPECT_NEAR(degreesFromRadians(back->verticalFov), degreesFromRadians(camera.verticalFov), 1e-6);
}

const Camera kSomewhere{.position = {412345.6789, 4212345.4321, 3210.9876},
                        .heading = radiansFromDegrees(359.9999999),
                        .pitch = radiansFromDegrees(-33.3333333),
                        .verticalFov = radiansFromDegrees(47.1234567)};

TEST(Camera, ComesBackFromItsTextInPlaneCoordinates) {
    expectRoundTrip(kSomewhere, nullptr);
}

#if TERRAY_WITH_PROJ
TEST(Camera, ComesBackFromItsTextInLongitudeAndLatitude) {
    const auto utm = Projection::create("EPSG:32613");
    ASSERT_TRUE(utm.ok()) << utm.failure().message;
    expectRoundTrip(kSomewhere, &*utm);
    Camera west = kSomewhere;
    west.heading = radiansFromDegrees(180);
    expectRoundTrip(west, &*utm);
}

TEST(Camera, HeadingInTheTextCountsFromTrueNorth) {
    const auto utm = Projection::create("EPSG:32613");  // central meridian 105 W
    ASSERT_TRUE(utm.ok());
    const auto camera = parseCamera("-106.5,38,3000,0,0", &*utm);
    ASSERT_TRUE(camera.ok()) << camera.failure().message;
    // A step to the true north along the view axis keeps the longitude.
    const View view = viewOf(*camera, 1, 1);
    const auto ahead = utm->lonLat(glm::dvec2(view.eye + 1000.0 * view.forward));
    ASSERT_TRUE(ahead.ok());
    EXPECT_NEAR(ahead->longitude, -106.5, 1e-7);
    EXPECT_GT(ahead->latitude, 38.008);
    EXPECT_GT(std::abs(std::remainder(degreesFromRadians(camera->heading), 360)), 0.5) << "meridians converge here";
}

TEST(Camera, RefusesPlacesThatAreNone) {
    const auto utm = Projection::create("EPSG:32613");
    ASSERT_TRUE(utm.ok());
    EXPECT_FALSE(parseCamera("181,0,0,0,0", &*utm).ok());
    EXPECT_FALSE(parseCamera("0,90.5,0,0,0", &*utm).ok());
}
#endif

}  // namespace
}  // namespace terray::test
