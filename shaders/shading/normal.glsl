// shading/normal.glsl: the normal of the ground as drawn: east, north, up from -1 .. 1 to the bytes 0 .. 255 of red, green, blue.
#ifndef TERRAY_SHADING_NORMAL
#define TERRAY_SHADING_NORMAL
#include "nodes.glsl"
#include "shading/legend.glsl"

vec3 groundColour(NodeParameters node, vec4 hit, vec2 slope, vec2 position) {
    vec2 rise = slope * (node.right.w / node.eye.w);  // metres per metre to the east and to the south
    return linearFromSrgb(0.5 + 0.5 * normalize(vec3(-rise.x, rise.y, 1.0)));
}

#endif
