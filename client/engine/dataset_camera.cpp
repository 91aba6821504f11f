#include "client/engine/dataset_camera.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "common/error.h"

namespace terray {

std::optional<Projection> projectionOf(const DatasetMetadata& metadata) {
    if (metadata.crsWkt.empty() || !TERRAY_WITH_PROJ) return {};
    Result<Projection> projection = Projection::create(metadata.crsWkt);
    if (!projection)
        throw Error(ExitCode::georeference, "cannot use the dataset's coordinate system " + metadata.crsName + ": " +
                                                projection.failure().message);
    return std::move(projection).value();
}

Camera overviewCamera(const DatasetMetadata& metadata, double aspect) {
    constexpr double kPitchDegrees = -40;
    const GroundRect ground = metadata.groundBounds();
    const glm::dvec3 low{ground.west, ground.south, metadata.minHeight};
    const glm::dvec3 high{ground.east, ground.north, metadata.maxHeight};

    Camera camera;
    camera.pitch = radiansFromDegrees(kPitchDegrees);
    const double tanHalfHeight = std::tan(camera.verticalFov.value() / 2);
    const double halfAngle = std::atan(tanHalfHeight * std::min(1.0, aspect));
    const double distance = glm::length(high - low) / 2 / std::sin(halfAngle);
    const double pitch = camera.pitch.value();
    camera.position = (low + high) / 2.0 - distance * glm::dvec3{0, std::cos(pitch), std::sin(pitch)};
    return camera;
}

}  // namespace terray
