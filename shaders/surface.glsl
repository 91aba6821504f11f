// surface.glsl: the smooth slope of a height tile. Frame: tile (codes per texel).
#ifndef TERRAY_SURFACE
#define TERRAY_SURFACE
#include "heights.glsl"

// A code as a height, or `other` where there is no surface, so that the rim of a hole is not a cliff.
float codeOr(ivec2 cell, uint slot, float other) {
    uint code = texelFetch(heightCodes, ivec3(cell + kApron, slot), 0).r;
    return code == 0u ? other : float(code);
}

// Gradient at a point of the core: central differences at the four nearest sample centres, interpolated bilinearly. It is
// continuous across cells and, by the apron of 2, across tiles of a level.
vec2 smoothGradient(vec2 position, uint slot, float heightHere) {
    vec2 fromCentre = clamp(position, vec2(0.0), vec2(float(kCore))) - 0.5;
    ivec2 c = ivec2(floor(fromCentre));
    vec2 f = fromCentre - vec2(c);
    // The 4 x 4 cells around, without the corners: name is column, row.
    float h10 = codeOr(c + ivec2(0, -1), slot, heightHere), h20 = codeOr(c + ivec2(1, -1), slot, heightHere);
    float h01 = codeOr(c + ivec2(-1, 0), slot, heightHere), h11 = codeOr(c, slot, heightHere);
    float h21 = codeOr(c + ivec2(1, 0), slot, heightHere), h31 = codeOr(c + ivec2(2, 0), slot, heightHere);
    float h02 = codeOr(c + ivec2(-1, 1), slot, heightHere), h12 = codeOr(c + ivec2(0, 1), slot, heightHere);
    float h22 = codeOr(c + ivec2(1, 1), slot, heightHere), h32 = codeOr(c + ivec2(2, 1), slot, heightHere);
    float h13 = codeOr(c + ivec2(0, 2), slot, heightHere), h23 = codeOr(c + ivec2(1, 2), slot, heightHere);
    vec4 slopeX = 0.5 * vec4(h21 - h01, h31 - h11, h22 - h02, h32 - h12);
    vec4 slopeY = 0.5 * vec4(h12 - h10, h22 - h20, h13 - h11, h23 - h21);
    vec4 weight = vec4((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y);
    return vec2(dot(slopeX, weight), dot(slopeY, weight));
}

#endif
