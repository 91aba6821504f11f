// shading/height.glsl: hypsometric colours from the lowest to the highest height of the dataset, whatever the exaggeration.
#ifndef TERRAY_SHADING_HEIGHT
#define TERRAY_SHADING_HEIGHT
#include "nodes.glsl"
#include "shading/legend.glsl"
#include "shading/parameters.glsl"

const uint kHeightStops[kStops] = uint[](0x5f9168u, 0xa0bd7fu, 0xdcd59au, 0xd2ae74u, 0xb0835au, 0xb9aba3u, 0xf7f7f7u);

vec3 groundColour(NodeParameters node, vec4 hit, vec2 slope, vec2 position) {
    float range = max(shading.heights.y - shading.heights.x, 1e-3);  // a plain is all lowland
    float place = (heightOfCode(node, hit.z) - shading.heights.x) / range;
    return rampColour(kHeightStops, place * float(kStops - 1));
}

#endif
