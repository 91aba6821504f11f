#pragma once

#include <string>

#include <glm/vec3.hpp>

#include "common/projection.h"
#include "common/result.h"
#include "common/units.h"
#include "common/view.h"

namespace terray {

/// Where the eye is and where it looks, in the dataset's world frame (x east, y north, z up, metres).
struct Camera {
    glm::dvec3 position{0};
    Radians heading;                               ///< of the view axis, clockwise from grid north (the y axis)
    Radians pitch;                                 ///< of the view axis above the horizontal plane, -pi/2 .. pi/2
    Radians verticalFov = radiansFromDegrees(45);  ///< full angle, above 0 and below pi

    bool operator==(const Camera&) const = default;
};

/// The picture that a camera takes. Looking straight up or down, heading still says where the picture's top points
/// (down: its top looks to the heading; up: its top looks away from it).
[[nodiscard]] View viewOf(const Camera& camera, int width, int height);

/// Where a camera must stand, looking as `camera` does, to have a box in its picture: backed off along the view axis
/// from the box's centre until every corner lies in the middle `share` of width and height.
/// @param low, high  the box's corners  @param aspect  width of the picture by its height
/// @param share      above 0; up to 1 the box is seen whole, above it the nearest corners lie outside
[[nodiscard]] Camera framing(Camera camera, const glm::dvec3& low, const glm::dvec3& high, double aspect, double share);

/// A camera as it is placed on the earth: degrees, heading from TRUE north, height above the dataset's vertical datum.
struct GeographicCamera {
    LonLat place;
    double height = 0;   ///< metres
    double heading = 0;  ///< 0 .. 360 where it is computed
    double pitch = 0;
    double fov = 45;  ///< vertical
};

/// Fail where the projection has no answer.
[[nodiscard]] Result<Camera> cameraFrom(const GeographicCamera& camera, const Projection& projection);
[[nodiscard]] Result<GeographicCamera> geographicCamera(const Camera& camera, const Projection& projection);

/// A camera as people write it: "lon,lat,height_m,heading_deg,pitch_deg[,fov_deg]", heading from TRUE north. With no
/// `projection` (a plain image, or a build without PROJ) the first two numbers are the dataset's x and y in metres and
/// heading counts from the y axis. Fails on anything but five or six finite numbers in their ranges, naming the
/// culprit.
[[nodiscard]] Result<Camera> parseCamera(const std::string& text, const Projection* projection);

/// The inverse of parseCamera, with digits enough to come back within 1 mm and 1e-6 degrees.
[[nodiscard]] Result<std::string> formatCamera(const Camera& camera, const Projection* projection);

}  // namespace terray
