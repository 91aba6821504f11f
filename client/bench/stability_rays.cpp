// Directions and origins of rays that fall on what a march is made of: axes, edges, corners, faces.
#include <array>
#include <cmath>
#include <numbers>

#include "client/bench/stability_scenes.h"

namespace terray {
namespace {

constexpr glm::dvec3 kUp{0, 0, 1};
constexpr double kDiagonal = std::numbers::sqrt2 / 2;

/// East, north, west, south; then between them.
constexpr std::array<glm::dvec3, 4> kAxes{{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}};
constexpr std::array<glm::dvec3, 4> kDiagonals{
    {{kDiagonal, kDiagonal, 0}, {-kDiagonal, kDiagonal, 0}, {-kDiagonal, -kDiagonal, 0}, {kDiagonal, -kDiagonal, 0}}};

/// From each place in each direction, level.
std::vector<View> lookAlong(std::span<const glm::dvec3> directions, std::span<const glm::dvec3> eyes) {
    std::vector<View> views;
    for (const glm::dvec3& eye : eyes)
        for (const glm::dvec3& direction : directions) views.push_back(along(eye, direction, kUp));
    return views;
}

/// The hills seen in these directions from places given as column, row, height.
StabilityScene overHills(std::span<const glm::dvec3> directions, const std::vector<glm::dvec3>& places) {
    StabilityScene scene{.ground = hills()};
    std::vector<glm::dvec3> eyes;
    for (const glm::dvec3& place : places) eyes.push_back(over(scene.ground, place.x, place.y, place.z));
    scene.views = lookAlong(directions, eyes);
    return scene;
}

StabilityScene vertical() {
    StabilityScene scene{.ground = hills()};
    for (const glm::dvec3& place :
         {glm::dvec3(300.5, 400.5, 300), glm::dvec3(512, 512, 300), glm::dvec3(7, 0.25, 60)}) {
        const glm::dvec3 eye = over(scene.ground, place.x, place.y, place.z);
        scene.views.push_back(along(eye, -kUp, {0, 1, 0}));
        scene.views.push_back(along(eye, kUp, {0, -1, 0}));
    }
    return scene;
}

/// Components of the axes that ought to be 0 are instead.
StabilityScene nearlyZero(double component) {
    StabilityScene scene{.ground = hills()};
    const glm::dvec3 eye = over(scene.ground, 300.5, 400, 45);
    for (const glm::dvec3& axis : kAxes) {
        const glm::dvec3 off(axis.x == 0 ? component : axis.x, axis.y == 0 ? component : axis.y, component);
        View view = along(eye, axis, kUp);
        view.forward = off;
        scene.views.push_back(view);
    }
    View down = along(eye, -kUp, {0, 1, 0});
    down.forward = {component, component, -1};
    scene.views.push_back(down);
    return scene;
}

/// Looks around from a place, and up and down.
void lookAround(StabilityScene& scene, const glm::dvec3& eye) {
    for (int heading = 0; heading < 360; heading += 45) scene.views.push_back(looking(eye, heading, -5));
    scene.views.push_back(along(eye, -kUp, {0, 1, 0}));
    scene.views.push_back(along(eye, kUp, {0, -1, 0}));
}

StabilityScene from(const std::vector<glm::dvec3>& places) {
    StabilityScene scene{.ground = hills()};
    for (const glm::dvec3& place : places) lookAround(scene, over(scene.ground, place.x, place.y, place.z));
    return scene;
}

StabilityScene onTheSurface() {
    StabilityScene scene{.ground = hills()};
    for (const glm::ivec2& sample : {glm::ivec2(300, 400), glm::ivec2(512, 512), glm::ivec2(0, 0)})
        lookAround(scene,
                   over(scene.ground, sample.x + 0.5, sample.y + 0.5, storedHeight(scene.ground, sample.x, sample.y)));
    return scene;
}

/// 30 km of ground from 10,000 km away, through a telescope.
StabilityScene farOutside() {
    FormulaDataset::Shape shape = kShape;
    shape.spacing = 30;
    StabilityScene scene{.ground = groundOf(shape, [](int64_t x, int64_t y) { return 30 * hillAt(x, y); })};
    const Frame frame{.fovDegrees = 0.2};
    const glm::dvec3 middle = over(scene.ground, 512, 512, 0);
    for (int heading = 0; heading < 360; heading += 60)
        for (const double pitch : {-0.5, -20.0, -90.0}) {
            const View axes = looking(middle, heading, pitch, frame);
            View view = axes;
            view.eye = middle - 1e7 * axes.forward;
            scene.views.push_back(view);
        }
    return scene;
}

}  // namespace

void addRayCases(std::vector<StabilityCase>& cases) {
    const auto add = [&](const char* name, const std::function<StabilityScene()>& scene) {
        cases.push_back({name, scene});
    };
    add("directions/axis-parallel", [] { return overHills(kAxes, {{300.3, 400.7, 30}, {300.3, 400.7, 2}}); });
    add("directions/vertical", vertical);
    add("directions/signed zeros", [] { return nearlyZero(-0.0); });
    add("directions/denormal", [] { return nearlyZero(1e-41); });
    add("directions/least denormal of doubles", [] { return nearlyZero(5e-324); });
    add("directions/in a cell edge", [] { return overHills(kAxes, {{300, 400, 20}, {512, 512, 20}, {300, 400, 0}}); });
    add("directions/between sample centres", [] {
        return overHills(kAxes, {{300.5, 400.5, 20}, {511.5, 512.5, 20}, {300.5, 400.5, 0}});
    });
    add("directions/corners at every level", [] {
        return overHills(kDiagonals, {{0, 0, 45}, {512, 512, 20}, {256, 256, 20}, {1024, 1024, 45}});
    });
    add("directions/diagonals of cells", [] {
        return overHills(kDiagonals, {{300.5, 400.5, 20}, {511.5, 512.5, 20}, {300.25, 400.75, 20}});
    });
    add("origin/on a face of a box", [] { return from({{0, 300.3, 20}, {1024, 300.3, 20}, {300.3, 512, 20}}); });
    add("origin/on an edge of a box", [] { return from({{0, 0, 20}, {512, 512, 20}, {0, 300.3, 60}}); });
    add("origin/on a corner of a box", [] { return from({{0, 0, storedHeight(hills(), 0, 0)}, {512, 512, 46}}); });
    add("origin/on the surface", onTheSurface);
    add("origin/inside the ground", [] { return from({{300.3, 400.7, -35}, {512, 512, -60}, {1, 1, -10}}); });
    add("origin/below everything", [] { return from({{300.3, 400.7, -500}, {-50, 400.7, -200}}); });
    add("origin/10,000 km away", farOutside);
}

}  // namespace terray
