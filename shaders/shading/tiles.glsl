// shading/tiles.glsl: a colour for each tile that heights come from, by a hash of its id. Neighbours of a level lie in
// different quadrants of their parents, and quadrants have hues a quarter of the circle apart.
#ifndef TERRAY_SHADING_TILES
#define TERRAY_SHADING_TILES
#include "nodes.glsl"
#include "shading/legend.glsl"

vec3 groundColour(NodeParameters node, vec4 hit, vec2 slope, vec2 position) {
    uint hash = node.source.w >> TERRAY_TILE_HASH_SHIFT;
    float level = float((node.source.w >> TERRAY_TILE_LEVEL_SHIFT) & TERRAY_TILE_LEVEL_MASK);
    float jitter = float((hash >> 2) & 0x7fu) / 128.0;
    // Levels are a golden section of the circle apart.
    float hue = fract(0.618034 * level + (float(hash & 3u) + 0.7 * jitter) / 4.0);
    float grey = mix(0.45, 0.65, float((hash >> 9) & 7u) / 7.0);
    float value = mix(0.8, 0.95, float((hash >> 12) & 15u) / 15.0);
    vec3 pure = clamp(abs(6.0 * fract(hue + vec3(0.0, 2.0, 1.0) / 3.0) - 3.0) - 1.0, vec3(0.0), vec3(1.0));
    return linearFromSrgb(value * mix(pure, vec3(1.0), grey));
}

#endif
