#pragma once

#include <optional>
#include <string>

#include <glm/vec3.hpp>

#include "client/navigation/ground.h"
#include "common/projection.h"
#include "common/units.h"

namespace terray {

/// Steepness of the ground at a place, over a step to each side; none where one of them has no ground.
[[nodiscard]] std::optional<Radians> slopeAt(Ground& ground, glm::dvec2 place, Metres step);

/// A place in words, a line each: longitude and latitude where a projection is given, x and y, height.
[[nodiscard]] std::string describePlace(const glm::dvec3& place, const Projection* projection);

/// The length of a scale bar: 1, 2 or 5 times a power of ten metres, at most `longest`, which is > 0.
[[nodiscard]] Metres scaleBarLength(Metres longest);

/// "350 m", "1.25 km".
[[nodiscard]] std::string lengthText(Metres length);
/// "12.3 MB": powers of 1024.
[[nodiscard]] std::string bytesText(double bytes);

}  // namespace terray
