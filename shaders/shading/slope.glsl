// shading/slope.glsl: steepness of the dataset's ground, whatever the exaggeration: the ramp's stops are 0, 10, 20 .. 60 degrees.
#ifndef TERRAY_SHADING_SLOPE
#define TERRAY_SHADING_SLOPE
#include "nodes.glsl"
#include "shading/legend.glsl"

const uint kSlopeStops[kStops] = uint[](0xf4f3ecu, 0xc9deb0u, 0xf5e27au, 0xf2a33fu, 0xd9482fu, 0x8f1d5cu, 0x2d1140u);

vec3 groundColour(NodeParameters node, vec4 hit, vec2 slope, vec2 position) {
    float rise = length(slope) * (node.right.w * frame.air.z / node.eye.w);  // metres per metre
    return rampColour(kSlopeStops, degrees(atan(rise)) / 10.0);
}

#endif
