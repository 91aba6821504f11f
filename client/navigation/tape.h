#pragma once

#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "client/navigation/ground.h"
#include "common/projection.h"
#include "common/units.h"

namespace terray {

/// What a measuring tape between two places reads.
struct TapeReading {
    Metres straight{0};     ///< on the ellipsoid (geodesic), or in the plane where nothing tells the place on the earth
    Metres alongGround{0};  ///< over hill and dale; holes are crossed level
    Metres climb{0};        ///< sum of all that rises
    std::vector<glm::dvec3> profile;  ///< places of the ground, evenly along the tape in the dataset's plane
};

/// @param projection  may be null
[[nodiscard]] TapeReading readTape(Ground& ground, glm::dvec2 from, glm::dvec2 to, const Projection* projection);

}  // namespace terray
