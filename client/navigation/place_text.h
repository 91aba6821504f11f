#pragma once

#include <string>

#include <glm/vec2.hpp>

#include "common/projection.h"
#include "common/result.h"

namespace terray {

/// The place of a dataset's plane that a person names: "lat, lon" in degrees of WGS 84, or "x, y" in metres of the
/// dataset's coordinates. Two numbers, comma or blanks between them; they are degrees where a projection is given, the
/// first is within -90 .. 90 and the second within -180 .. 180.
[[nodiscard]] Result<glm::dvec2> parsePlace(const std::string& text, const Projection* projection);

}  // namespace terray
