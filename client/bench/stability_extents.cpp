// Where ground ends: level jumps, mirrors, holes, the smallest datasets.
#include <cmath>
#include <limits>
#include <string>

#include "client/bench/stability_scenes.h"

namespace terray {
namespace {

constexpr double kHole = std::numeric_limits<double>::quiet_NaN();

/// Flat ground but for one finest tile, south-east of the middle, that is a checkerboard: its neighbours are drawn from
/// tiles up to `jump` levels coarser, since these are exact at their samples, where this dataset's errors hold.
StabilityScene levelJump(uint32_t jump) {
    constexpr double kRough = 4;  // metres, up and down
    const uint32_t finest = jump + 1;
    const int64_t middle = int64_t{kTileCore} << (finest - 1);
    FormulaDataset::Shape shape = kShape;
    shape.samples = {2 * middle, 2 * middle};
    shape.errorsHoldEverywhere = false;
    const auto cells = [middle](uint32_t up, int64_t column, int64_t row) -> FormulaCell {
        const auto isRough = [&](int64_t at) { return at << up >= middle && at << up < middle + kTileCore; };
        if (!isRough(column) || !isRough(row)) return {0, 0, 0};
        const double height = (column + row) % 2 == 0 ? kRough : -kRough;
        return up == 0 ? FormulaCell{height, height, height} : FormulaCell{0, -kRough, kRough};
    };
    StabilityScene scene{.ground = std::make_shared<const FormulaDataset>(shape, cells), .relief = kRough};
    const auto eye = [&](double column, double row, double z) {
        return over(scene.ground, static_cast<double>(middle) + column, static_cast<double>(middle) + row, z);
    };
    for (int heading = 0; heading < 360; heading += 45)
        scene.views.push_back(looking(eye(3.3, 5.7, 12), heading, -10, {.fovDegrees = 70}));
    scene.views.push_back(looking(eye(-40, -40, 30), 135, -30));
    scene.views.push_back(looking(eye(0, 256, 6), 0, -1));
    scene.views.push_back(along(eye(0, 0, 30), {0, 0, -1}, {0, 1, 0}));
    return scene;
}

/// The hills, and the hills seen in a mirror that exchanges columns (or rows).
StabilityScene mirrored(bool columns) {
    const int64_t last = kShape.samples.width - 1;
    StabilityScene scene{.ground = hills(), .mirroredGround = groundOf(kShape, [=](int64_t x, int64_t y) {
                                                return columns ? hillAt(last - x, y) : hillAt(x, last - y);
                                            })};
    // Even pictures, since a ray straight ahead has no side; places and pixels that floats hold exactly.
    const Frame frame{.fovDegrees = 50, .width = 64, .height = 32};
    for (int heading = 5; heading < 360; heading += 40) {
        const View view = looking(over(scene.ground, 301.25, 400.75, 60.5), heading, columns ? -15 : 0, frame);
        View other = view;
        const Tiling& tiling = scene.ground->metadata().tiling;
        const double side = static_cast<double>(kShape.samples.width);
        double glm::dvec3::*axis = columns ? &glm::dvec3::x : &glm::dvec3::y;
        other.eye.*axis = (columns ? 2 * tiling.west + side : 2 * tiling.north - side) - view.eye.*axis;
        // The mirrored axes are left-handed; with right turned round the picture's columns are exchanged.
        for (glm::dvec3 View::*of : {&View::forward, &View::right, &View::up}) (other.*of).*axis *= -1;
        other.right *= -1;
        scene.views.push_back(view);
        scene.mirroredViews.push_back(other);
    }
    return scene;
}

/// Around from above places given as column, row, height.
StabilityScene around(const Ground& ground, const std::vector<glm::dvec3>& places) {
    StabilityScene scene{.ground = ground};
    for (const glm::dvec3& place : places) {
        const glm::dvec3 eye = over(ground, place.x, place.y, place.z);
        for (int heading = 0; heading < 360; heading += 60)
            for (const double pitch : {-4.0, -35.0}) scene.views.push_back(looking(eye, heading, pitch));
        scene.views.push_back(along(eye, {0, 0, -1}, {0, 1, 0}));
    }
    return scene;
}

/// Whether a sample is missing.
using Missing = bool (*)(int64_t column, int64_t row);

StabilityScene holes(Missing missing) {
    const Ground ground =
        groundOf(kShape, [missing](int64_t x, int64_t y) { return missing(x, y) ? kHole : hillAt(x, y); });
    return around(ground, {{300.3, 400.7, 55}, {512, 512, 50}, {5, 6, 50}, {1020, 1000, 60}});
}

StabilityScene ofSize(int64_t columns, int64_t rows) {
    FormulaDataset::Shape shape = kShape;
    shape.samples = {columns, rows};
    const Ground ground = groundOf(shape, [](int64_t x, int64_t y) { return 5 + hillAt(x, y) / 20; });
    const auto x = static_cast<double>(columns), y = static_cast<double>(rows);
    StabilityScene scene = around(ground, {{x / 2, y / 2, 9}, {0, 0, 8}, {x, y, 12}});
    scene.views.push_back(looking(over(ground, x / 2, y + 5, 9), 0, -20));
    scene.views.push_back(looking(over(ground, -5, y / 2, 7), 90, -10));
    return scene;
}

}  // namespace

void addExtentCases(std::vector<StabilityCase>& cases) {
    const auto add = [&](const std::string& name, const std::function<StabilityScene()>& scene) {
        cases.push_back({name, scene});
    };
    for (const uint32_t jump : {1U, 2U, 5U})
        add("levels/a jump of " + std::to_string(jump), [jump] { return levelJump(jump); });
    add("mirror/of columns", [] { return mirrored(true); });
    add("mirror/of rows", [] { return mirrored(false); });
    add("holes/single samples", [] { return holes([](int64_t x, int64_t y) { return x % 7 == 0 && y % 5 == 0; }); });
    add("holes/at corners", [] {
        return holes([](int64_t x, int64_t y) {
            const auto atEnd = [](int64_t at) { return at % 512 < 9 || at % 512 > 502; };
            return atEnd(x) && atEnd(y);
        });
    });
    add("holes/at edges",
        [] { return holes([](int64_t x, int64_t y) { return x < 3 || x == 512 || x == 1023 || y == 511; }); });
    add("holes/whole tiles", [] { return holes([](int64_t x, int64_t y) { return (x < 512) == (y < 512); }); });
    add("extent/one sample", [] { return ofSize(1, 1); });
    add("extent/one row", [] { return ofSize(700, 1); });
    add("extent/one column", [] { return ofSize(1, 700); });
    add("extent/one tile", [] { return ofSize(512, 512); });
}

}  // namespace terray
