// shading/residency.glsl: whether the ground is drawn from the tiles that were wanted, or ancestors stand in for tiles that are
// not resident: for heights, for the photo, for both.
#ifndef TERRAY_SHADING_RESIDENCY
#define TERRAY_SHADING_RESIDENCY
#include "nodes.glsl"
#include "shading/legend.glsl"

vec3 groundColour(NodeParameters node, vec4 hit, vec2 slope, vec2 position) {
    bool heights = (node.source.w & TERRAY_HEIGHT_STAND_IN_BIT) != 0u;
    bool photo = (node.source.w & TERRAY_PHOTO_STAND_IN_BIT) != 0u;
    if (heights && photo) return legendColour(0xb03a6eu);
    if (heights) return legendColour(0xe8883cu);
    return legendColour(photo ? 0x4f8fcbu : 0x9cc48bu);
}

#endif
