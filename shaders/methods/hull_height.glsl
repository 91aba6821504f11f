// methods/hull_height.glsl: the pushed-up mesh (HullTiles). Frame: tile; heights in codes.
#ifndef TERRAY_METHOD_HULL_HEIGHT
#define TERRAY_METHOD_HULL_HEIGHT
#include "interop.h"

layout(binding = TERRAY_UNIT_METHOD) uniform sampler2DArray hulls;

float hullHeight(ivec2 vertex, uint slot) { return texelFetch(hulls, ivec3(vertex, slot), 0).r; }

// Between vertices; the diagonal of a quad runs from its south-west to its north-east corner.
float hullAt(vec2 texel, uint slot) {
    int side = textureSize(hulls, 0).x - 1;
    vec2 place = clamp(texel, vec2(0.0), vec2(512.0)) * (float(side) / 512.0);
    ivec2 quad = min(ivec2(place), ivec2(side - 1));
    vec2 at = place - vec2(quad);
    float h10 = hullHeight(quad + ivec2(1, 0), slot), h01 = hullHeight(quad + ivec2(0, 1), slot);
    if (at.x + at.y <= 1.0) {
        float h00 = hullHeight(quad, slot);
        return h00 + at.x * (h10 - h00) + at.y * (h01 - h00);
    }
    float h11 = hullHeight(quad + ivec2(1, 1), slot);
    return h11 + (1.0 - at.x) * (h01 - h11) + (1.0 - at.y) * (h10 - h11);
}

#endif
