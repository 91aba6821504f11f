// Very small and very large numbers: spacings, coordinates, distances, angles, heights, curvatures, pictures.
#include <cmath>
#include <string>

#include "client/bench/stability_scenes.h"

namespace terray {
namespace {

/// Around and down from above the middle, as many samples away whatever their spacing.
StabilityScene scaled(const FormulaDataset::Shape& shape) {
    const double spacing = shape.spacing;
    StabilityScene scene{.ground = groundOf(shape, [spacing](int64_t x, int64_t y) { return spacing * hillAt(x, y); })};
    for (int heading = 0; heading < 360; heading += 60)
        scene.views.push_back(looking(over(scene.ground, 512.3, 500.7, 46 * spacing), heading, -8));
    scene.views.push_back(looking(over(scene.ground, 512, 512, 300 * spacing), 20, -90));
    return scene;
}

FormulaDataset::Shape spaced(double spacing, double quantum) {
    FormulaDataset::Shape shape = kShape;
    shape.spacing = spacing;
    shape.quantum = quantum;
    return shape;
}

StabilityScene farFromZero() {
    FormulaDataset::Shape shape = spaced(0.01, 1e-4);
    shape.west = 1e7;
    shape.north = -1e7;
    return scaled(shape);
}

/// Ground from 10 cm before the eye to 600 km away.
StabilityScene farAndNear(double above) {
    StabilityScene scene{.ground = groundOf(spaced(600, 0.01), [](int64_t x, int64_t) {
                             return x < 4 ? 0.0 : 40 * std::sin(static_cast<double>(x) / 5);
                         })};
    const glm::dvec3 eye = over(scene.ground, 2, 512, storedHeight(scene.ground, 2, 512) + above);
    for (const double pitch : {0.0, -30.0, -90.0}) scene.views.push_back(looking(eye, 90, pitch, {.fovDegrees = 60}));
    scene.views.push_back(looking(eye, 45, -10, {.fovDegrees = 120}));
    return scene;
}

/// Ground so thin that the box around it ends before the eye's nearest millimetre.
StabilityScene underTheEye(double above) {
    StabilityScene scene{.ground = groundOf(spaced(1, 1e-6), [](int64_t, int64_t) { return 1.0; })};
    const glm::dvec3 eye = over(scene.ground, 300.3, 400.7, storedHeight(scene.ground, 300, 400) + above);
    for (const double pitch : {-90.0, -60.0, -20.0}) scene.views.push_back(looking(eye, 40, pitch));
    return scene;
}

StabilityScene withFov(double degrees) {
    StabilityScene scene{.ground = hills()};
    const Frame frame{.fovDegrees = degrees};
    for (int heading = 0; heading < 360; heading += 60)
        for (const double pitch : {-2.0, -20.0, -90.0})
            scene.views.push_back(looking(over(scene.ground, 300.3, 400.7, 60), heading, pitch, frame));
    return scene;
}

StabilityScene withExaggeration(double factor) {
    StabilityScene scene{.ground = hills()};
    for (int heading = 0; heading < 360; heading += 60)
        for (const double pitch : {-1.0, -20.0, -90.0})
            scene.views.push_back(exaggerated(looking(over(scene.ground, 300.3, 400.7, 60), heading, pitch), factor));
    return scene;
}

/// @param curvature  1 / R, per metre
StabilityScene withEarth(double curvature) {
    StabilityScene scene{.ground = hills()};
    for (int heading = 0; heading < 360; heading += 60)
        for (const double pitch : {10.0, -2.0, -20.0, -90.0}) {
            View view = looking(over(scene.ground, 300.3, 400.7, 60), heading, pitch);
            view.earth = EarthCurvature{.xx = curvature / 2, .xy = 0, .yy = curvature / 2};
            scene.views.push_back(view);
        }
    scene.views.push_back(along(over(scene.ground, 300.5, 400.5, 60), {0, 0, -1}, {0, 1, 0}));
    scene.views.back().earth = EarthCurvature{.xx = curvature / 2, .xy = 0, .yy = curvature / 2};
    return scene;
}

StabilityScene withPicture(int width, int height) {
    StabilityScene scene{.ground = hills()};
    const double fov = height > width ? 90 : 45;
    scene.views.push_back(
        looking(over(scene.ground, 300.3, 400.7, 60), 75, -12, {.fovDegrees = fov, .width = width, .height = height}));
    return scene;
}

}  // namespace

void addScaleCases(std::vector<StabilityCase>& cases) {
    const auto add = [&](const std::string& name, const std::function<StabilityScene()>& scene) {
        cases.push_back({name, scene});
    };
    add("scale/spacing of 1 cm", [] { return scaled(spaced(0.01, 1e-4)); });
    add("scale/spacing of 1 km", [] { return scaled(spaced(1000, 1)); });
    add("scale/spacing of 1 cm at coordinates of 10,000 km", farFromZero);
    add("scale/600 km, and 10 cm", [] { return farAndNear(0.1); });
    add("scale/600 km, and 1 mm", [] { return farAndNear(0.001); });
    add("scale/ground 1 cm away", [] { return underTheEye(0.01); });
    add("scale/ground 0.1 mm away", [] { return underTheEye(1e-4); });
    add("scale/field of view of 0.001 degrees", [] { return withFov(0.001); });
    add("scale/field of view of 170 degrees", [] { return withFov(170); });
    add("scale/exaggeration of 0.01", [] { return withExaggeration(0.01); });
    add("scale/exaggeration of 100", [] { return withExaggeration(100); });
    add("earth/of infinite radius", [] { return withEarth(0); });
    add("earth/of 100 km radius", [] { return withEarth(1e-5); });
    add("earth/of 300 m radius", [] { return withEarth(1.0 / 300); });
    add("picture/of 1 pixel", [] { return withPicture(1, 1); });
    add("picture/of 16384 x 2 pixels", [] { return withPicture(16384, 2); });
    add("picture/of 2 x 16384 pixels", [] { return withPicture(2, 16384); });
}

}  // namespace terray
