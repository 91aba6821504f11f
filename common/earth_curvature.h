#pragma once

#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>

#include "common/projection.h"
#include "common/tiling.h"
#include "common/units.h"

namespace terray {

// Looking over a curved earth in a flat map.
//
// The map is flat; in it a straight line of sight is a parabola that gains height with the square of the map distance
// from the eye. The same said the other way: seen from the eye, ground at a distance looks lowered by its `drop`, and
// then lines of sight are straight. Rays are bent by this form (shaders/math/bend.glsl), boxes are lowered by it.
//
// The form is Euler's: along a line the ellipsoid curves by east^2 / N + north^2 / M, with the prime-vertical and
// meridional radii at the eye's latitude, and the drop is distance^2 / (2 R). Three corrections cost nothing:
//
//   Displacements on the map are turned and scaled into true ones by the projection's derivative at the eye.
//
//   Air bends light down, in an arc of a k-th of the earth's curvature: R becomes R / (1 - k), the effective radius.
//
//   1 / R becomes (1 + h / 2 R) / R for an eye at height h: the horizon then dips as on a sphere. Without it the worst
//   errors at 600 km are 16 arcseconds in place of 11; a horizon seen from 12 km is off by 382 m and 7.2 arcseconds.
//
// Error against exact geodesy: lines of sight of 1 to 600 km on the WGS 84 ellipsoid at latitudes 0, 45, 70 in four
// azimuths, eyes at 2 m to 12 km, targets at 0 to 8 km, k 0 and 0.13, by geodesics and geocentric coordinates
// (tests/common/earth_accuracy_test.cpp asserts it and prints the table of tests/bench/REPORT.md). On a map true to
// distance and azimuth from the eye, worst error of the apparent elevation in arcseconds:
//
//   line of sight, km                        1     3    10    30   100   300   600
//   any                                     62   126   128    65    21     8    11
//   within 10 degrees of the horizontal      1     6     4    35    21     8    11
//
// (A pixel of 720 in 45 degrees is 237.) What is large, near and steep, is not the parabola's doing: on a map plumb
// lines are parallel, so at height z all is too narrow by z / R, which turns a line by up to z / 2R radians. Horizon
// from 2, 100, 1500, 12000 m: its distance within 0.2, 1, 16, 200 m, its dip within 0.02, 0.02, 0.2, 1.4 arcseconds.
//
// Heights count from the ellipsoid here. Those of most datasets count from the geoid, which deviates from it by up to
// 100 m and leans by up to about a minute of arc.

/// Height in metres that a line of sight gains over the map, (xx dx + xy dy) dx + yy dy^2 for a displacement of dx
/// metres to the map's east and dy to its north. Positive definite; all zero: a flat earth. Per metre.
struct EarthCurvature {
    double xx = 0;
    double xy = 0;
    double yy = 0;

    bool operator==(const EarthCurvature&) const = default;

    [[nodiscard]] double drop(double dx, double dy) const { return (xx * dx + xy * dy) * dx + yy * dy * dy; }
    [[nodiscard]] double drop(glm::dvec2 displacement) const { return drop(displacement.x, displacement.y); }
};

/// Coefficient of terrestrial refraction, the ray's curvature over the earth's: Gauss's mean of 1826, by which
/// surveyors still go. It varies, from below 0 over hot ground to above 1 over cold water.
inline constexpr double kStandardRefraction = 0.13;

/// Who looks, and through what air.
struct Sight {
    double eyeHeight = 0;                     ///< metres above the ellipsoid; below 0 counts as 0
    double refraction = kStandardRefraction;  ///< k, below 1; 0: light goes straight
};

/// @param latitude       of the eye, degrees
/// @param groundFromMap  as Projection::groundFromPlane() at the eye. A conformal map of point scale s on which true
///                       north lies g clockwise of the y axis: columns (cos g, sin g) / s and (-sin g, cos g) / s
[[nodiscard]] EarthCurvature earthCurvature(double latitude, const glm::dmat2& groundFromMap, const Sight& sight);

/// At a place of a map. Fails where the projection has no place there, and in builds without PROJ.
[[nodiscard]] Result<EarthCurvature> earthCurvature(const Projection& projection, glm::dvec2 place, const Sight& sight);

/// Of a sphere of the earth's mean radius under a map in true metres, for maps of unknown place: R is wrong by up to
/// 0.6 % with latitude and direction, which is 55 arcseconds of elevation at 600 km.
[[nodiscard]] EarthCurvature sphericalEarth(const Sight& sight);

/// Least and greatest drop over a part of the map, metres.
struct DropRange {
    double least = 0;
    double greatest = 0;
};

/// Exact but for rounding.
[[nodiscard]] DropRange dropOver(const EarthCurvature& earth, const GroundRect& ground, glm::dvec2 eye);

}  // namespace terray
