#include "client/bench/stability_scenes.h"

#include <cmath>

#include <glm/geometric.hpp>

#include "client/stream/camera.h"

namespace terray {

Ground groundOf(const FormulaDataset::Shape& shape, const FormulaDataset::Heights& heights) {
    return std::make_shared<const FormulaDataset>(shape, heights);
}

double hillAt(int64_t column, int64_t row) {
    const auto x = static_cast<double>(column), y = static_cast<double>(row);
    return 40 * std::sin(x / 33) * std::cos(y / 41) + 5 * std::sin((x + 2 * y) / 7) +
           std::sin(x * 1.7) * std::sin(y * 2.3);
}

Ground hills() {
    return groundOf(kShape, hillAt);
}

glm::dvec3 over(const Ground& ground, double column, double row, double height) {
    const Tiling& tiling = ground->metadata().tiling;
    return {tiling.west + column * tiling.finestSpacing, tiling.north - row * tiling.finestSpacing, height};
}

double storedHeight(const Ground& ground, int64_t column, int64_t row) {
    const TileId id{ground->metadata().tiling.finestLevel, static_cast<uint32_t>(column / kTileCore),
                    static_cast<uint32_t>(row / kTileCore)};
    const HeightTile tile = decodeHeightTile(ground->read(TileLayer::heights, id).value()).value();
    return tile.encoding.height(tile.codes.at(column % kTileCore + kHeightApron, row % kTileCore + kHeightApron));
}

View looking(const glm::dvec3& eye, double headingDegrees, double pitchDegrees, const Frame& frame) {
    const Camera camera{.position = eye,
                        .heading = radiansFromDegrees(headingDegrees),
                        .pitch = radiansFromDegrees(pitchDegrees),
                        .verticalFov = radiansFromDegrees(frame.fovDegrees)};
    return viewOf(camera, frame.width, frame.height);
}

View along(const glm::dvec3& eye, const glm::dvec3& forward, const glm::dvec3& up, const Frame& frame) {
    View view = looking(eye, 0, 0, frame);
    view.forward = forward;
    view.up = up;
    view.right = glm::cross(forward, up);
    return view;
}

std::vector<StabilityCase> stabilityCases() {
    std::vector<StabilityCase> cases;
    addRayCases(cases);
    addShapeCases(cases);
    addScaleCases(cases);
    addExtentCases(cases);
    return cases;
}

}  // namespace terray
