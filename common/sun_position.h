#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "common/geodesy.h"
#include "common/projection.h"
#include "common/result.h"
#include "common/units.h"
#include "common/utc_time.h"

namespace terray {

/// Where the sun's centre is seen from the earth's, referred to the true equator and equinox of the date.
struct SunEquatorial {
    Radians rightAscension;  ///< 0 .. 2 pi
    Radians declination;
    double distance = 1;  ///< astronomical units
};

/// Where the sun's centre stands for somebody on the ground.
struct SunAngles {
    Radians azimuth;    ///< clockwise from true north, 0 .. 2 pi
    Radians elevation;  ///< above the horizontal plane, -pi/2 .. pi/2
};

/// Whether the air lifts the sun.
enum class Refraction {
    none,      ///< the sun as it is
    standard,  ///< as it is seen through air of 1010 hPa and 10 degrees C
};

/// The sun's place in the sky, from Meeus 1998, "Astronomical Algorithms", second edition, chapter 25 (low accuracy:
/// elliptic motion, the chief term of nutation, aberration).
///
/// Error below 0.011 degrees of arc over 1900 to 2100, measured against ERFA 2.0.0 (epv00, nutation 2006/2000A,
/// aberration) at 20,000 random times; it comes from the planets' pull, which is left out.
[[nodiscard]] SunEquatorial sunEquatorial(UtcTime when);

/// Direction towards the sun at a place on the WGS 84 ellipsoid, with the parallax of the ground.
///
/// Error without refraction: below 0.015 degrees of arc over 1900 to 2100 (0.010 measured as above at random places,
/// and 0.004 for the up to 0.9 s by which UTC and the turning earth differ). Refraction after Saemundsson 1986
/// ("Astronomical refraction", Sky and Telescope 72, 70): within 0.1 arc minute above 15 degrees at sea level. The real
/// air moves a sun on the horizon by 0.1 degree and more about the standard's 0.48. Below -1 degree, where nobody sees
/// it, it fades to 0 at -3.
[[nodiscard]] SunAngles sunAngles(UtcTime when, LonLat place, Refraction refraction = Refraction::standard);

/// Unit vector of two angles: x to the east, y to the north, z up, when the azimuth counts from there.
[[nodiscard]] glm::dvec3 directionOf(const SunAngles& angles);

/// Unit vector towards the sun in a dataset's world frame (x and y along the grid's axes, z up) at a place given in it:
/// the azimuth is turned by the angle between true north and the grid's, Projection::gridHeadingOfNorth, whose error of
/// 1e-6 radians is far below the sun's. Holds for conformal projections; others also shear azimuths.
/// Fails where the projection does.
[[nodiscard]] Result<glm::dvec3> gridSunDirection(UtcTime when, const Projection& projection, glm::dvec2 place);

}  // namespace terray
