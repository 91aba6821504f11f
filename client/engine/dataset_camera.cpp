#include "client/engine/dataset_camera.h"

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

    return framing({.pitch = radiansFromDegrees(kPitchDegrees)}, low, high, aspect, 0.9);
}

}  // namespace terray
