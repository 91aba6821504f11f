#pragma once

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

/// EPSG code of the metric system that suits a place: WGS 84 / UTM of its zone (326zz north, 327zz south, with the
/// exceptions of Norway and Svalbard), and the polar stereographic UPS (5041, 5042) beyond 84 N and 80 S.
[[nodiscard]] int metricEpsg(LonLat place);

}  // namespace terray
