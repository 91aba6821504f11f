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

Camera overviewCamera(const DatasetMetadata& metadata, double aspect, const EarthModel& earth, double exaggeration) {
    constexpr double kPitchDegrees = -40;
    const GroundRect ground = metadata.groundBounds();
    const glm::dvec3 low{ground.west, ground.south, exaggeration * metadata.minHeight};
    const glm::dvec3 high{ground.east, ground.north, exaggeration * metadata.maxHeight};

    const auto framed = [&](const DropRange& drop) {
        Camera camera =
            framing({.pitch = radiansFromDegrees(kPitchDegrees)}, low - glm::dvec3(0, 0, exaggeration * drop.greatest),
                    high - glm::dvec3(0, 0, exaggeration * drop.least), aspect, 0.9);
        camera.position.z /= exaggeration;
        return camera;
    };
    // How low the ground is seen depends on where the eye is; a second look moves it little, a third hardly.
    Camera camera = framed({});
    for (int look = 0; look < 2; ++look)
        if (const auto curvature = earth.at(camera.position))
            camera = framed(dropOver(*curvature, ground, glm::dvec2(camera.position)));
    return camera;
}

}  // namespace terray
