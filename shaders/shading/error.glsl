// shading/error.glsl: how large the geometric error of the height source is on the screen at the hit's distance, against the
// tolerance: the ramp's stops are 1/8, 1/4, 1/2, 1 and, over the tolerance, 2, 4, 8 times it, where the colour starts at that of 2.
#ifndef TERRAY_SHADING_ERROR
#define TERRAY_SHADING_ERROR
#include "nodes.glsl"
#include "shading/legend.glsl"
#include "shading/parameters.glsl"

const uint kErrorStops[kStops] = uint[](0x2f5fa6u, 0x4fa3c7u, 0x8cc79au, 0xe9e6a8u, 0xf0973au, 0xd23a2eu, 0x7a1450u);

vec3 groundColour(NodeParameters node, vec4 hit, vec2 slope, vec2 position) {
    float distance = hit.w * length(frame.forward.xyz + position.x * frame.right.xyz + position.y * frame.up.xyz);
    float pixels = node.forward.w / distance * (0.5 * frame.up.w / length(frame.up.xyz));
    float place = log2(max(pixels / shading.heights.w, 1e-6)) + 3.0;
    return rampColour(kErrorStops, place > 3.0 ? max(place, 4.0) : place);
}

#endif
