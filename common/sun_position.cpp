#include "common/sun_position.h"

#include <algorithm>
#include <cmath>

#include "common/check.h"

namespace terray {
namespace {

constexpr double kDaysPerCentury = 36525;
constexpr double kSecondsPerDay = 86400;
/// Terrestrial time less UTC. It was -3 s in 1900 and 69 s in 2020; in 100 s the sun moves by 0.0011 degrees.
constexpr double kTerrestrialLessUtcSeconds = 69;

double radians(double degrees) {
    return radiansFromDegrees(degrees).value();
}

/// An angle in 0 .. 2 pi.
double wrapped(double angle) {
    constexpr double kTurn = 2 * std::numbers::pi;
    const double rest = std::fmod(angle, kTurn);
    return rest < 0 ? rest + kTurn : rest;
}

/// Days since noon of the first of January 2000, on the clock that is given.
double daysSince2000(UtcTime when) {
    using namespace std::chrono;
    constexpr auto kEpoch = sys_days(year(2000) / 1 / 1) + hours(12);
    return static_cast<double>((when - kEpoch).count()) / (1000 * kSecondsPerDay);
}

double terrestrialCenturies(UtcTime when) {
    return (daysSince2000(when) + kTerrestrialLessUtcSeconds / kSecondsPerDay) / kDaysPerCentury;
}

/// Longitude of the ascending node of the moon's orbit, whose turn in 18.6 years is the chief term of nutation.
double lunarNode(double t) {
    return radians(125.04 - 1934.136 * t);
}

/// Mean obliquity of the ecliptic (Meeus, formula 22.2).
double meanObliquity(double t) {
    const double arcSeconds = 84381.448 + t * (-46.8150 + t * (-0.00059 + t * 0.001813));
    return radians(arcSeconds / 3600);
}

/// Angle that the true equinox has turned through over Greenwich (Meeus, formula 12.4, and the chief term of nutation).
double siderealTime(UtcTime when) {
    const double days = daysSince2000(when);
    const double t = days / kDaysPerCentury;
    const double mean = 280.46061837 + 360.98564736629 * days + t * t * (0.000387933 - t / 38710000);
    const double centuries = terrestrialCenturies(when);
    return radians(mean) - radians(0.00478) * std::sin(lunarNode(centuries)) * std::cos(meanObliquity(centuries));
}

/// What the standard air adds to a true elevation; both in degrees.
double refractionDegrees(double elevation) {
    constexpr double kFadeFrom = -1;
    constexpr double kFadeTo = -3;
    const double h = std::max(elevation, kFadeFrom);
    const double arcMinutes = 1.02 / std::tan(radians(h + 10.3 / (h + 5.11)));
    const double fade = std::clamp((elevation - kFadeTo) / (kFadeFrom - kFadeTo), 0.0, 1.0);
    return fade * std::max(arcMinutes, 0.0) / 60;
}

}  // namespace

SunEquatorial sunEquatorial(UtcTime when) {
    const double t = terrestrialCenturies(when);
    // The orbit: mean longitude, mean anomaly, eccentricity, equation of the centre (Meeus, 25.2 to 25.5).
    const double meanLongitude = 280.46646 + t * (36000.76983 + t * 0.0003032);
    const double anomalyDegrees = 357.52911 + t * (35999.05029 - t * 0.0001537);
    const double anomaly = radians(anomalyDegrees);
    const double eccentricity = 0.016708634 - t * (0.000042037 + t * 0.0000001267);
    const double centre = (1.914602 - t * (0.004817 + t * 0.000014)) * std::sin(anomaly) +
                          (0.019993 - t * 0.000101) * std::sin(2 * anomaly) + 0.000289 * std::sin(3 * anomaly);
    const double trueAnomaly = radians(anomalyDegrees + centre);
    const double distance =
        1.000001018 * (1 - eccentricity * eccentricity) / (1 + eccentricity * std::cos(trueAnomaly));

    // Aberration and nutation: the apparent place.
    const double node = lunarNode(t);
    const double longitude = radians(meanLongitude + centre - 0.00569 - 0.00478 * std::sin(node));
    const double obliquity = meanObliquity(t) + radians(0.00256) * std::cos(node);
    return {
        .rightAscension = Radians(wrapped(std::atan2(std::cos(obliquity) * std::sin(longitude), std::cos(longitude)))),
        .declination = Radians(std::asin(std::sin(obliquity) * std::sin(longitude))),
        .distance = distance};
}

SunAngles sunAngles(UtcTime when, LonLat place, Refraction refraction) {
    TERRAY_CHECK_OP(std::abs(place.latitude), <=, 90);
    TERRAY_CHECK_OP(std::abs(place.longitude), <=, 360);
    const SunEquatorial sun = sunEquatorial(when);
    const double hourAngle = siderealTime(when) + radians(place.longitude) - sun.rightAscension.value();
    const double latitude = radians(place.latitude);
    const double declination = sun.declination.value();

    // East, north, up of the unit vector to the sun.
    const double east = -std::cos(declination) * std::sin(hourAngle);
    const double north =
        std::cos(latitude) * std::sin(declination) - std::sin(latitude) * std::cos(declination) * std::cos(hourAngle);
    const double up =
        std::sin(latitude) * std::sin(declination) + std::cos(latitude) * std::cos(declination) * std::cos(hourAngle);
    const double level = std::hypot(east, north);

    // The ground is up to an earth's radius nearer to the sun's line than the earth's centre.
    constexpr double kParallaxDegrees = 8.794 / 3600;
    double elevation = degreesFromRadians(Radians(std::atan2(up, level)));
    elevation -= kParallaxDegrees / sun.distance * level;
    if (refraction == Refraction::standard) elevation += refractionDegrees(elevation);
    return {.azimuth = Radians(wrapped(std::atan2(east, north))),
            .elevation = radiansFromDegrees(std::clamp(elevation, -90.0, 90.0))};
}

glm::dvec3 directionOf(const SunAngles& angles) {
    const double turn = angles.azimuth.value();
    const double rise = angles.elevation.value();
    return {std::sin(turn) * std::cos(rise), std::cos(turn) * std::cos(rise), std::sin(rise)};
}

Result<glm::dvec3> gridSunDirection(UtcTime when, const Projection& projection, glm::dvec2 place) {
    const Result<LonLat> lonLat = projection.lonLat(place);
    if (!lonLat.ok()) return lonLat.failure();
    const Result<Radians> north = projection.gridHeadingOfNorth(place);
    if (!north.ok()) return north.failure();
    SunAngles sun = sunAngles(when, *lonLat);
    sun.azimuth = sun.azimuth + *north;
    return directionOf(sun);
}

}  // namespace terray
