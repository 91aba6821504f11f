#include "common/earth_curvature.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>

#include "common/check.h"

namespace terray {
namespace {

/// Metres. IUGG mean radius (2 a + b) / 3 of the ellipsoid.
constexpr double kMeanRadius = 6371008.8;

/// Half the curvature that a line of sight sees, per metre: the parabola through the eye that touches height 0 leaves
/// the eye at the angle at which a sphere's horizon does, tan^2 = ((R + h)^2 - R^2) / R^2.
double halfCurvature(double radius, const Sight& sight) {
    TERRAY_CHECK_OP(sight.refraction, <, 1.0);
    const double effective = radius / (1 - sight.refraction);
    return 0.5 / effective * (1 + 0.5 * std::max(sight.eyeHeight, 0.0) / effective);
}

/// Least value on a segment parallel to an axis of a quadratic a u^2 + b u v + c v^2: u is fixed, v in [low, high].
double leastOnEdge(const std::array<double, 3>& form, double u, double low, double high) {
    const auto [a, b, c] = form;
    const double v = c > 0 ? std::clamp(-b * u / (2 * c), low, high) : low;
    return (a * u + b * v) * u + c * v * v;
}

}  // namespace

EarthCurvature earthCurvature(double latitude, const glm::dmat2& groundFromMap, const Sight& sight) {
    const CurvatureRadii radii = curvatureRadii(latitude);
    const double east = halfCurvature(radii.primeVertical.value(), sight);
    const double north = halfCurvature(radii.meridian.value(), sight);
    const glm::dvec2 x = groundFromMap[0], y = groundFromMap[1];
    return {.xx = east * x.x * x.x + north * x.y * x.y,
            .xy = 2 * (east * x.x * y.x + north * x.y * y.y),
            .yy = east * y.x * y.x + north * y.y * y.y};
}

Result<EarthCurvature> earthCurvature(const Projection& projection, glm::dvec2 place, const Sight& sight) {
    const auto lonLat = projection.lonLat(place);
    if (!lonLat) return lonLat.failure();
    const auto groundFromMap = projection.groundFromPlane(place);
    if (!groundFromMap) return groundFromMap.failure();
    return earthCurvature(lonLat->latitude, *groundFromMap, sight);
}

EarthCurvature sphericalEarth(const Sight& sight) {
    const double half = halfCurvature(kMeanRadius, sight);
    return {.xx = half, .xy = 0, .yy = half};
}

DropRange dropOver(const EarthCurvature& earth, const GroundRect& ground, glm::dvec2 eye) {
    const double west = ground.west - eye.x, east = ground.east - eye.x;
    const double south = ground.south - eye.y, north = ground.north - eye.y;
    // Convex: the greatest value is at a corner, the least at the eye or, when that is outside, on an edge.
    const double greatest =
        std::max({earth.drop(west, south), earth.drop(east, south), earth.drop(west, north), earth.drop(east, north)});
    if (west <= 0 && east >= 0 && south <= 0 && north >= 0) return {0, greatest};
    const std::array<double, 3> form{earth.xx, earth.xy, earth.yy}, turned{earth.yy, earth.xy, earth.xx};
    return {std::min({leastOnEdge(form, west, south, north), leastOnEdge(form, east, south, north),
                      leastOnEdge(turned, south, west, east), leastOnEdge(turned, north, west, east)}),
            greatest};
}

}  // namespace terray
