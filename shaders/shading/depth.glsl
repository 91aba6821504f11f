// shading/depth.glsl: view depth on a logarithmic ramp of half decades: its stops are 100 m, 316 m, 1 km, ... 100 km.
#ifndef TERRAY_SHADING_DEPTH
#define TERRAY_SHADING_DEPTH
#include "nodes.glsl"
#include "shading/legend.glsl"

const uint kDepthStops[kStops] = uint[](0xffffffu, 0xfdf6b2u, 0xfecb5cu, 0xf0703eu, 0xa2296bu, 0x3a1f78u, 0x060a2au);
const float kNearest = 100.0;              // metres
const float kHalfDecadesPerLog2 = 0.60206;

vec3 groundColour(NodeParameters node, vec4 hit, vec2 slope, vec2 position) {
    return rampColour(kDepthStops, kHalfDecadesPerLog2 * log2(max(hit.w / kNearest, 1.0)));
}

#endif
