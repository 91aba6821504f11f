#include "client/engine/sun_clock.h"

#include <optional>
#include <string>

#include "client/engine/dataset_camera.h"
#include "common/error.h"
#include "common/sun_position.h"

namespace terray {
namespace {

Projection requireProjection(const DatasetMetadata& metadata) {
    const std::string purpose = "cannot find the sun of a time of day over the dataset: ";
    const std::string instead = " (give --sun AZIMUTH,ELEVATION instead)";
    if (metadata.crsWkt.empty())
        throw Error(ExitCode::georeference,
                    purpose + "it has no coordinate system that says where on the earth it lies" + instead);
    std::optional<Projection> projection = projectionOf(metadata);
    if (!projection)
        throw Error(ExitCode::unsupported,
                    purpose + "this build has no map projections (configured with TERRAY_WITH_PROJ=OFF)" + instead);
    return std::move(*projection);
}

}  // namespace

SunClock::SunClock(UtcTime time, const DatasetMetadata& metadata)
    : time_(time), projection_(requireProjection(metadata)) {}

glm::dvec3 SunClock::direction(glm::dvec2 place) const {
    const Result<glm::dvec3> direction = gridSunDirection(time_, projection_, place);
    if (!direction.ok())
        throw Error(ExitCode::georeference, "cannot find the sun over the camera: " + direction.failure().message +
                                                " (bring the camera nearer, or give --sun AZIMUTH,ELEVATION)");
    return *direction;
}

}  // namespace terray
