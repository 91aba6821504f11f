// math/patch.glsl: a ray above the bilinear surface between four sample centres.
// Frame: of the patch; u and v run from 0 to 1 between the centres, along the tile frame's x and y; heights in codes.
// Source: Ramsey, Potter, Hansen 2004, "Ray Bilinear Patch Intersections"; paper 000, section 3.7. A height field needs
// only the quadratic in the ray's own parameter: u and v are linear in it.
#ifndef TERRAY_MATH_PATCH
#define TERRAY_MATH_PATCH
#include "math/contact.glsl"
#include "math/portable.glsl"

struct Corners {
    real h00;  // u = 0, v = 0
    real h10;  // u = 1
    real h01;  // v = 1
    real h11;
};

MATH_FUNCTION real patchHeight(Corners corners, real u, real v) {
    real west = corners.h00 + v * (corners.h01 - corners.h00);
    real east = corners.h10 + v * (corners.h11 - corners.h10);
    return west + u * (east - west);
}

// at: u, v and height of the ray where it enters. direction: their change per unit of s. bend: the height gains
// bend * s * s (0 for a straight ray).
MATH_FUNCTION Clearance patchClearance(Corners corners, vec3 at, vec3 direction, real bend) {
    real twist = (corners.h11 - corners.h01) - (corners.h10 - corners.h00);
    real alongU = (corners.h10 - corners.h00) + at.y * twist;
    real alongV = (corners.h01 - corners.h00) + at.x * twist;
    Clearance clearance;
    clearance.bend = bend - twist * direction.x * direction.y;
    clearance.slope = direction.z - alongU * direction.x - alongV * direction.y;
    clearance.start = at.z - patchHeight(corners, at.x, at.y);
    return clearance;
}

#endif
