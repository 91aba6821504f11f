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
    // Back along the view axis until every corner of the box lies inside the picture, with a margin of a tenth.
    const View view = viewOf(camera, 1000, std::max(static_cast<int>(1000 / aspect), 1));
    const glm::dvec3 centre = (low + high) / 2.0;
    double distance = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 place(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z);
        const glm::dvec3 fromCentre = place - centre;
        const double across = std::abs(glm::dot(fromCentre, view.right)) / view.tanHalfWidth();
        const double along = std::abs(glm::dot(fromCentre, view.up)) / view.tanHalfHeight;
        distance = std::max(distance, std::max(across, along) / 0.9 - glm::dot(fromCentre, view.forward));
    }
    camera.position = centre - distance * view.forward;
    return camera;
}

}  // namespace terray
