#pragma once

#include <optional>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "common/view.h"

// How a point of the ground is held in its place on the picture while the eye moves. All points are in the view's world
// (z exaggerated); pixels count from the picture's upper-left corner. Exact over a flat and over a curved earth.

namespace terray {

/// Where a point is seen from the eye, over a curved earth lowered by its drop: metres along the world's axes.
[[nodiscard]] glm::dvec3 seenOffset(const View& view, const glm::dvec3& point);

/// The eye that sees a point at an offset: the inverse of seenOffset().
[[nodiscard]] glm::dvec3 eyeSeeing(const View& view, const glm::dvec3& point, const glm::dvec3& offset);

/// The pixel at which a point is seen; none behind the eye.
[[nodiscard]] std::optional<glm::dvec2> pixelOf(const View& view, const glm::dvec3& point);

/// The eye, at its height and with the view's axes, that sees a grabbed point at a pixel. None where it would have to
/// go farther than kFarthestDrag times the point's distance: at the horizon and above it.
[[nodiscard]] std::optional<glm::dvec3> eyeDragged(const View& view, const glm::dvec3& grabbed, glm::dvec2 pixel);
inline constexpr double kFarthestDrag = 20;

/// The eye that sees a point at the same pixel after the view's axes have turned.
/// @param turned  axes of the turned view
[[nodiscard]] glm::dvec3 eyeOrbited(const View& view, const View& turned, const glm::dvec3& pivot);

/// The eye that sees a point at the same pixel from `factor` times its distance, > 0.
[[nodiscard]] glm::dvec3 eyeZoomed(const View& view, const glm::dvec3& point, double factor);

}  // namespace terray
