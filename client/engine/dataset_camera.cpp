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

Camera overviewCamera(const DatasetMetadata& metadata, double aspect, double exaggeration) {
    constexpr double kPitchDegrees = -40;
    const GroundRect ground = metadata.groundBounds();
    const glm::dvec3 low{ground.west, ground.south, exaggeration * metadata.minHeight};
    const glm::dvec3 high{ground.east, ground.north, exaggeration * metadata.maxHeight};

    Camera camera = framing({.pitch = radiansFromDegrees(kPitchDegrees)}, low, high, aspect, 0.9);
    camera.position.z /= exaggeration;
    return camera;
}

}  // namespace terray
