// Grounds that are as flat, as steep and as rough as heights can be, and rays along them.
#include <array>
#include <cmath>
#include <string>

#include "client/bench/stability_scenes.h"

namespace terray {
namespace {

double degreesOfSlope(double slope) {
    return degreesFromRadians(Radians(std::atan(slope)));
}

/// A roof along y, its ridge on the centres of a column of samples.
Ground roof() {
    return groundOf(kShape,
                    [](int64_t column, int64_t) { return 50 - 0.5 * std::abs(static_cast<double>(column - 400)); });
}

/// Down along the ridge, so that the middle ray meets it about 300 m away; rays of a picture are a slope apart or less.
StabilityScene grazing(double slope) {
    StabilityScene scene{.ground = roof()};
    const Frame frame{.fovDegrees = degreesOfSlope(4 * slope)};
    const double height = storedHeight(scene.ground, 400, 500) + 300 * slope;
    scene.views.push_back(looking(over(scene.ground, 400.5, 900.5, height), 0, -degreesOfSlope(slope), frame));
    scene.views.push_back(looking(over(scene.ground, 400.5, 100.5, height), 180, -degreesOfSlope(slope), frame));
    scene.views.push_back(looking(over(scene.ground, 400.25, 900.25, height), 0.01, -degreesOfSlope(slope), frame));
    return scene;
}

/// From above, along, and from below.
void lookAt(StabilityScene& scene, double height, double above) {
    for (int heading = 0; heading < 360; heading += 90)
        for (const double pitch : {-60.0, -5.0, 0.0, 30.0})
            scene.views.push_back(looking(over(scene.ground, 300.3, 400.7, height + above), heading, pitch));
    scene.views.push_back(looking(over(scene.ground, 300.3, 400.7, height - above), 30, 60));
    scene.views.push_back(along(over(scene.ground, 512, 512, height + above), {0, 0, -1}, {0, 1, 0}));
}

StabilityScene constant(double height) {
    StabilityScene scene{.ground = groundOf(kShape, [height](int64_t, int64_t) { return height; })};
    lookAt(scene, height, 100);
    lookAt(scene, height, 1e5);  // some 10^7 codes
    return scene;
}

/// In the plane of the ground, and a little above and below it.
StabilityScene inThePlane() {
    StabilityScene scene{.ground = groundOf(kShape, [](int64_t, int64_t) { return 100.0; })};
    const double height = storedHeight(scene.ground, 300, 400);
    for (const double above : {0.0, 1e-9, -1e-9, 1e-4, -1e-4})
        for (const double heading : {0.0, 90.0, 213.7})
            scene.views.push_back(looking(over(scene.ground, 300.3, 400.7, height + above), heading, 0));
    return scene;
}

/// From so far above that floats tell heights apart by 8 codes, and the box of the ground is thinner than that.
StabilityScene fromFarAbove() {
    FormulaDataset::Shape shape = kShape;
    shape.spacing = 10;
    StabilityScene scene{.ground = groundOf(shape, [](int64_t, int64_t) { return 123.45; })};
    for (const double column : {512.0, 300.3})
        scene.views.push_back(
            along(over(scene.ground, column, 400.7, 1e6), {0, 0, -1}, {0, 1, 0}, {.fovDegrees = 0.4}));
    return scene;
}

StabilityScene overWholeRange() {
    StabilityScene scene{.ground = groundOf(kShape, [](int64_t column, int64_t row) {
                             return 11000 * std::sin(static_cast<double>(column) / 160) *
                                    std::cos(static_cast<double>(row) / 160);
                         })};
    lookAt(scene, 11000, 500);
    lookAt(scene, 0, 5000);
    return scene;
}

/// All one height, but for one sample.
StabilityScene oneSample(double height) {
    StabilityScene scene{.ground = groundOf(kShape, [height](int64_t column, int64_t row) {
                             return column == 300 && row == 400 ? height : 0;
                         })};
    const auto eye = [&](double column, double row, double z) { return over(scene.ground, column, row, z); };
    scene.views = {along(eye(300.5, 400.5, 9500), {0, 0, -1}, {0, 1, 0}, {.fovDegrees = 0.05}),
                   along(eye(300.3, 400.6, 9500), {0, 0, -1}, {0, 1, 0}, {.fovDegrees = 60}),
                   looking(eye(300.5, 700.5, 4000), 0, 0, {.fovDegrees = 1}),
                   looking(eye(300.5, 700.5, 4000), 0, 0, {.fovDegrees = 100}),
                   looking(eye(700.5, 800.5, 100), 315, 20, {.fovDegrees = 80}),
                   looking(eye(301.5, 401.5, 10), 315, -20)};
    return scene;
}

/// Along the border of two tiles: every level's samples have it exactly, but not what lies between them.
StabilityScene cliff() {
    StabilityScene scene{
        .ground = groundOf(kShape, [](int64_t column, int64_t) { return column < kTileCore ? 0.0 : 900.0; })};
    const auto eye = [&](double column, double row, double z) { return over(scene.ground, column, row, z); };
    scene.views = {looking(eye(400, 400, 450), 90, 0),       looking(eye(511.9, 900, 450), 0, 0),
                   looking(eye(512, 900, 450), 0, 0),        looking(eye(512, 900, 905), 0, -1),
                   looking(eye(600, 400.5, 950), 270, -20),  along(eye(512, 512, 950), {0, 0, -1}, {0, 1, 0}),
                   looking(eye(511.5, 300.5, 1), 180.5, 45), looking(eye(513, 300, 900.5), 185, -0.5)};
    return scene;
}

StabilityScene checkerboard(double height) {
    StabilityScene scene{.ground = groundOf(kShape, [height](int64_t column, int64_t row) {
                             return (column + row) % 2 == 0 ? height : -height;
                         })};
    lookAt(scene, 0, height + 0.5);
    lookAt(scene, 0, height + 300);
    scene.views.push_back(looking(over(scene.ground, 0.5, 0.5, height + 1), 135, -0.1));
    return scene;
}

}  // namespace

void addShapeCases(std::vector<StabilityCase>& cases) {
    const auto add = [&](const std::string& name, const std::function<StabilityScene()>& scene) {
        cases.push_back({name, scene});
    };
    for (int power = 3; power <= 7; ++power)
        add("grazing/a ridge at a slope of 1e-" + std::to_string(power),
            [power] { return grazing(std::pow(10.0, -power)); });
    add("flat/rays in its plane", inThePlane);
    add("flat/constant height", [] { return constant(123.45); });
    add("flat/100 million codes below the eye", fromFarAbove);
    add("flat/at 11 km", [] { return constant(11000); });
    add("flat/at -11 km", [] { return constant(-11000); });
    add("steep/from -11 km to 11 km", overWholeRange);
    add("steep/a spike of 9 km", [] { return oneSample(9000); });
    add("steep/a pit of 9 km", [] { return oneSample(-9000); });
    add("steep/a cliff along a tile's border", cliff);
    add("steep/a checkerboard of 1 quantum", [] { return checkerboard(0.01); });
    add("steep/a checkerboard of 9 km", [] { return checkerboard(9000); });
}

}  // namespace terray
