// math/bend.glsl: the height of a ray over a curved earth, drawn flat.
// Frame: tile. In the flat map a straight ray is a parabola: its height gains bend * t * t, bend >= 0 (design, section 5).
// t: view depth in metres; heights in codes.
#ifndef TERRAY_MATH_BEND
#define TERRAY_MATH_BEND
#include "math/portable.glsl"

MATH_FUNCTION real bentHeight(real eyeZ, real directionZ, real bend, real t) {
    return eyeZ + t * (directionZ + bend * t);
}

// Change of height per unit of t.
MATH_FUNCTION real bentSlope(real directionZ, real bend, real t) { return directionZ + REAL(2.0) * bend * t; }

#endif
