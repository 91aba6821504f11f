// math/atmosphere.glsl: what the air is made of and how a straight ray runs through it, over a spherical earth.
// Colours are three wavelengths, 634, 543 and 442 nm: those that come nearest to linear sRGB of the whole spectrum (5778 K;
// matching functions of Wyman, Sloan, Shirley 2013), for sunlight and skylight through 1 to 8 masses of air within 15 % of red
// and 5 % of green and blue. Metres. Heights count from the sea. A ray is given by the height of its origin and the cosine of
// its angle to the zenith there.
// Float keeps its digits because everything is written in heights: 6371 km squared would lose kilometres.
#ifndef TERRAY_MATH_ATMOSPHERE
#define TERRAY_MATH_ATMOSPHERE
#include "math/portable.glsl"

const real kEarthRadius = REAL(6371000.0);  // mean radius
const real kAirTop = REAL(100000.0);        // height above which no light is scattered; density is 7e-6 of the sea's
const real kSunRadius = REAL(0.004654);     // angular, at the mean distance

// Air molecules at sea level (288.15 K, 1013.25 hPa): scattering, 1/m. Their scale height is pressure over weight, so the
// whole column is right. Source: Bucholtz 1995, "Rayleigh-scattering calculations for the terrestrial atmosphere", table 3
// (doi 10.1364/AO.34.002765); US Standard Atmosphere 1976.
const vec3 kMolecules = vec3(REAL(6.440e-6), REAL(12.096e-6), REAL(28.200e-6));
const real kMoleculeScale = REAL(8434.0);

// Aerosol: extinction relative to 543 nm (exponent 1.3, Angstrom 1929), share that is scattered and not absorbed, scale
// height (Elterman 1968), asymmetry of scattering.
const vec3 kAerosolColour = vec3(REAL(0.8176), REAL(1.0), REAL(1.3067));
const real kAerosolAlbedo = REAL(0.92);
const real kAerosolScale = REAL(1200.0);
const real kAerosolAsymmetry = REAL(0.78);

// Ozone: absorption where it is densest, 1/m, for 300 Dobson units in a tent from 10 to 40 km with its ridge at 25 km.
// Source: cross-sections at 293 K of Serdyuchenko and others 2014 (doi 10.5194/amt-7-625-2014); the tent is that of
// Bruneton 2017.
const vec3 kOzone = vec3(REAL(1.609e-6), REAL(1.727e-6), REAL(0.0929e-6));
const real kOzoneRidge = REAL(25000.0);
const real kOzoneHalfWidth = REAL(15000.0);

// Contrast that an eye still sees at the visual range, as -ln(0.02). Source: Koschmieder 1924; WMO-No. 8.
const real kKoschmieder = REAL(3.912);

// Extinction of aerosol at sea level, 1/m. visualRange: of the air at sea level, metres, for 543 nm; pure air has 323 km.
MATH_FUNCTION vec3 aerosolExtinction(real visualRange) {
    return kAerosolColour * max(kKoschmieder / visualRange - kMolecules.y, REAL(0.0));
}

// Relative densities at a height.
MATH_FUNCTION real moleculeDensity(real height) { return exp(-height / kMoleculeScale); }
MATH_FUNCTION real aerosolDensity(real height) { return exp(-height / kAerosolScale); }
MATH_FUNCTION real ozoneDensity(real height) {
    return max(REAL(1.0) - abs(height - kOzoneRidge) / kOzoneHalfWidth, REAL(0.0));
}

// Light that is scattered by an angle, per steradian; the integral over the sphere is 1.
// Source: Rayleigh 1871; Cornette and Shanks 1992 (doi 10.1364/AO.31.003152).
MATH_FUNCTION real moleculePhase(real cosine) {
    const real k = REAL(0.0596831037);  // 3 / (16 pi)
    return k * (REAL(1.0) + cosine * cosine);
}
MATH_FUNCTION real aerosolPhase(real cosine) {
    const real k = REAL(0.1193662073);  // 3 / (8 pi)
    real g = kAerosolAsymmetry;
    real base = REAL(1.0) + g * g - REAL(2.0) * g * cosine;
    return k * (REAL(1.0) - g * g) * (REAL(1.0) + cosine * cosine) / ((REAL(2.0) + g * g) * base * sqrt(base));
}

// Height above the sphere at a distance along a ray.
MATH_FUNCTION real heightAlong(real height, real cosine, real distance) {
    real radius = kEarthRadius + height;
    real gained = distance * (distance + REAL(2.0) * radius * cosine);
    return height + gained / (radius + sqrt(max(radius * radius + gained, REAL(0.0))));
}

// Cosine of the zenith angle that a fixed direction has at a distance along the ray. directionCosine: at the ray's origin;
// between: of the angle between ray and direction.
MATH_FUNCTION real cosineAlong(real height, real distance, real directionCosine, real between, real heightThere) {
    real there = ((kEarthRadius + height) * directionCosine + distance * between) / (kEarthRadius + heightThere);
    return min(max(there, -REAL(1.0)), REAL(1.0));
}

// Sine of the horizon's elevation, 0 or less.
MATH_FUNCTION real horizonCosine(real height) {
    real radius = kEarthRadius + height;
    return -sqrt(height * (REAL(2.0) * kEarthRadius + height)) / radius;
}

// Distance to the sea along a ray that meets it: cosine <= horizonCosine(height).
MATH_FUNCTION real seaDistance(real height, real cosine) {
    real radius = kEarthRadius + height;
    real power = height * (REAL(2.0) * kEarthRadius + height);
    real down = -radius * cosine;
    return power / (down + sqrt(max(down * down - power, REAL(0.0))));
}

// Distance to a sphere from inside it, where the ray leaves. top: its height, >= height.
MATH_FUNCTION real leavingDistance(real height, real cosine, real top) {
    real radius = kEarthRadius + height;
    real along = radius * cosine;
    real power = (top - height) * (REAL(2.0) * kEarthRadius + top + height);
    real root = sqrt(along * along + power);
    // Of the two forms, the one that adds.
    return along > REAL(0.0) ? power / (along + root) : root - along;
}

// Distance at which a ray from above the air enters it; below 0 when it passes by.
MATH_FUNCTION real enteringDistance(real height, real cosine, real top) {
    real radius = kEarthRadius + height;
    real along = radius * cosine;
    real power = (height - top) * (REAL(2.0) * kEarthRadius + top + height);
    real square = along * along - power;
    if (along >= REAL(0.0) || square < REAL(0.0)) return -REAL(1.0);
    return power / (sqrt(square) - along);
}

#endif
