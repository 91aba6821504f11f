// shading/level.glsl: one colour for each level of the tile that heights come from; after twelve they begin again.
#ifndef TERRAY_SHADING_LEVEL
#define TERRAY_SHADING_LEVEL
#include "nodes.glsl"
#include "shading/legend.glsl"

const uint kLevelColours[12] = uint[](0x8a5fa8u, 0x4c78b8u, 0x57b5c4u, 0x3f9b6bu, 0x9ccb5au, 0xf2dc5du, 0xf0a03cu, 0xd9583bu,
                                      0xe88fb1u, 0xa35a44u, 0xc9b79cu, 0x7d8790u);

vec3 groundColour(NodeParameters node, vec4 hit, vec2 slope, vec2 position) {
    uint level = (node.source.w >> TERRAY_TILE_LEVEL_SHIFT) & TERRAY_TILE_LEVEL_MASK;
    return legendColour(kLevelColours[level % 12u]);
}

#endif
