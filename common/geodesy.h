#pragma once

#include <glm/vec2.hpp>

#include "common/units.h"

namespace terray {

/// A place on the WGS 84 ellipsoid, degrees: longitude -180..180 to the east, latitude -90..90 to the north.
struct LonLat {
    double longitude = 0;
    double latitude = 0;
};

/// Length of the shortest line on the WGS 84 ellipsoid. Error below 15 nm (Karney 2013, "Algorithms for geodesics",
/// doi 10.1007/s00190-012-0578-z; GeographicLib).
[[nodiscard]] Metres geodesicDistance(LonLat from, LonLat to);

/// The shortest line from one place to another as its length to the east and to the north where it starts, metres:
/// length times sine and cosine of its azimuth there. At a pole north is along the longitude that `from` gives.
[[nodiscard]] glm::dvec2 geodesicOffset(LonLat from, LonLat to);

/// How the WGS 84 ellipsoid curves at a latitude: radii of the circles that touch it along the meridian and, at right
/// angles to it, along the prime vertical.
struct CurvatureRadii {
    Metres meridian;
    Metres primeVertical;
};
/// @param latitude  degrees, -90 .. 90
[[nodiscard]] CurvatureRadii curvatureRadii(double latitude);

/// EPSG code of the metric system that suits a place: WGS 84 / UTM of its zone (326zz north, 327zz south, with the
/// exceptions of Norway and Svalbard), and the polar stereographic UPS (5041, 5042) beyond 84 N and 80 S.
[[nodiscard]] int metricEpsg(LonLat place);

}  // namespace terray
