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

// When a bent ray is lowest; far behind or ahead for one that is not bent.
MATH_FUNCTION real lowestTime(real directionZ, real bend) {
    real tiny = REAL(1e-30);
    return -directionZ / max(REAL(2.0) * bend, tiny);
}

// As meetsColumn and columnTime (math/column.glsl). A parabola that opens upwards is least where its vertex is, or at the end
// of [enter, exit] that is nearest to that.
MATH_FUNCTION bool bentMeetsColumn(real top, real eyeZ, real directionZ, real bend, real lowest, real enter, real exit) {
    return bentHeight(eyeZ, directionZ, bend, max(enter, min(lowest, exit))) <= top;
}

// The earlier of the two crossings of `top`, in the form that adds numbers of one sign: the later one is a rise. Its height is
// off by the roundings of what adds up to it, as bentHeight's is.
MATH_FUNCTION real bentColumnTime(real top, real eyeZ, real directionZ, real bend, real enter, real exit) {
    real above = eyeZ - top;
    real root = sqrt(max(directionZ * directionZ - REAL(4.0) * bend * above, REAL(0.0)));
    real tiny = REAL(1e-30);
    return max(enter, min(REAL(2.0) * above / max(root - directionZ, tiny), exit));
}

#endif
