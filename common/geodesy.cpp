// The only door to GeographicLib.
#include "common/geodesy.h"

#include <cmath>

#include <GeographicLib/Ellipsoid.hpp>
#include <GeographicLib/Geodesic.hpp>
#include <GeographicLib/UTMUPS.hpp>

#include "common/check.h"

namespace terray {
namespace {

void checkPlace(LonLat place) {
    TERRAY_CHECK(std::isfinite(place.longitude));
    TERRAY_CHECK_OP(std::abs(place.latitude), <=, 90);
}

}  // namespace

Metres geodesicDistance(LonLat from, LonLat to) {
    checkPlace(from);
    checkPlace(to);
    double metres = 0;
    GeographicLib::Geodesic::WGS84().Inverse(from.latitude, from.longitude, to.latitude, to.longitude, metres);
    return Metres(metres);
}

glm::dvec2 geodesicOffset(LonLat from, LonLat to) {
    checkPlace(from);
    checkPlace(to);
    double metres = 0, azimuth = 0, azimuthThere = 0;
    GeographicLib::Geodesic::WGS84().Inverse(from.latitude, from.longitude, to.latitude, to.longitude, metres, azimuth,
                                             azimuthThere);
    const double angle = radiansFromDegrees(azimuth).value();
    return {metres * std::sin(angle), metres * std::cos(angle)};
}

CurvatureRadii curvatureRadii(double latitude) {
    checkPlace({.longitude = 0, .latitude = latitude});
    const GeographicLib::Ellipsoid& earth = GeographicLib::Ellipsoid::WGS84();
    return {.meridian = Metres(earth.MeridionalCurvatureRadius(latitude)),
            .primeVertical = Metres(earth.TransverseCurvatureRadius(latitude))};
}

int metricEpsg(LonLat place) {
    checkPlace(place);
    constexpr int kUpsNorth = 5041;  // eastings first, as everywhere here; 32661 has them second
    constexpr int kUpsSouth = 5042;
    const bool north = place.latitude >= 0;
    const int zone = GeographicLib::UTMUPS::StandardZone(place.latitude, place.longitude);
    if (zone == GeographicLib::UTMUPS::UPS) return north ? kUpsNorth : kUpsSouth;
    return (north ? 32600 : 32700) + zone;
}

}  // namespace terray
