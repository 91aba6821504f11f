// math/bend.glsl: the height of a ray over a curved earth, drawn flat.
// Frame: tile. In the flat map a straight ray is a parabola: its height gains bend * t * t, bend >= 0 (design, section 5).
// t: view depth in metres; heights in codes.
#ifndef TERRAY_MATH_BEND
#define TERRAY_MATH_BEND
#include "math/portable.glsl"

MATH_FUNCTION real bentHeight(real eyeZ, real directionZ, real bend, real t) {
    return eyeZ + t * (directionZ + bend * t);
}

// Metres by which ground lies lower, as seen from the eye, than a flat earth would show it. form: height gained per squared
// metre: east east, east north, north north. east, north: from the eye, metres (common/earth_curvature.h).
MATH_FUNCTION real earthDrop(vec3 form, real east, real north) {
    return (form.x * east + form.y * north) * east + form.z * north * north;
}

// How steeply it falls there: metres per metre to the east and to the north.
MATH_FUNCTION vec2 earthFall(vec3 form, real east, real north) {
    return vec2(REAL(2.0) * form.x * east + form.y * north, form.y * east + REAL(2.0) * form.z * north);
}

// Change of height per unit of t.
MATH_FUNCTION real bentSlope(real directionZ, real bend, real t) { return directionZ + REAL(2.0) * bend * t; }

#endif
