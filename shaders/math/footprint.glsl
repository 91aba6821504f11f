// math/footprint.glsl: the parallelogram of the ground that a pixel sees.
// Source: Dick, Krueger, Westermann 2009, section 3.3: project the two texel vectors, lifted onto the tangent plane, to the
// screen; then express the pixel's own two vectors in their basis.
#ifndef TERRAY_MATH_FOOTPRINT
#define TERRAY_MATH_FOOTPRINT
#include "math/portable.glsl"

struct Footprint {
    vec2 alongX;  // texels of the tile frame for one pixel to the right
    vec2 alongY;  // texels for one pixel up
};

// Pixels that a small displacement spans on the screen.
// view: the displacement in camera axes (right, up, forward), metres. slope: of the ray (right, up per forward).
// depth: view depth in metres, > 0. focal: pixels per unit of slope.
MATH_FUNCTION vec2 projected(vec3 view, vec2 slope, real depth, real focal) {
    return vec2((view.x - slope.x * view.z) * focal / depth, (view.y - slope.y * view.z) * focal / depth);
}

// texelX, texelY: pixels that the texel vectors (1, 0) and (0, 1) span. longest: limit of each result, texels; it takes
// effect where the surface is seen edge-on and the true footprint is without bound.
MATH_FUNCTION Footprint pixelFootprint(vec2 texelX, vec2 texelY, real longest) {
    real area = texelX.x * texelY.y - texelX.y * texelY.x;
    real smallest = REAL(1e-12);
    real inverse = REAL(1.0) / (area < REAL(0.0) ? min(area, -smallest) : max(area, smallest));
    Footprint result;
    result.alongX = vec2(texelY.y * inverse, -texelX.y * inverse);
    result.alongY = vec2(-texelY.x * inverse, texelX.x * inverse);
    result.alongX = result.alongX * min(REAL(1.0), longest / max(length(result.alongX), smallest));
    result.alongY = result.alongY * min(REAL(1.0), longest / max(length(result.alongY), smallest));
    return result;
}

#endif
