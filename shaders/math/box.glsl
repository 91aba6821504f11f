// math/box.glsl: where a ray enters and leaves an axis-aligned box.
// Frame: tile (texels, texels, codes). t: view depth in metres, P(t) = eye + t * direction; behind the eye counts as 0.
// Source: Kay and Kajiya 1986, "Ray tracing complex scenes" (slabs).
#ifndef TERRAY_MATH_BOX
#define TERRAY_MATH_BOX
#include "math/portable.glsl"

struct Interval {
    real enter;  // >= 0
    real exit;   // the ray misses the box when exit < enter; so does one within an upper face: that is the next box's lower
};

// A reciprocal that is finite for 0, -0 and denormals, so that slabs need no special cases: 0 * inf never arises.
// 1e-30 texels per metre displace a ray by less than any float's last place at any distance that a view can have.
MATH_FUNCTION real safeInverse(real component) {
    const real tiny = REAL(1e-30);
    real magnitude = max(abs(component), tiny);
    return component < REAL(0.0) ? -REAL(1.0) / magnitude : REAL(1.0) / magnitude;
}

MATH_FUNCTION Interval boxInterval(vec3 eye, vec3 inverse, vec3 boxMin, vec3 boxMax) {
    vec3 a = (boxMin - eye) * inverse;
    vec3 b = (boxMax - eye) * inverse;
    vec3 nearest = min(a, b);
    vec3 farthest = max(a, b);
    Interval span;
    span.enter = max(max(nearest.x, nearest.y), max(nearest.z, REAL(0.0)));
    span.exit = min(min(farthest.x, farthest.y), farthest.z);
    return span;
}

#endif
