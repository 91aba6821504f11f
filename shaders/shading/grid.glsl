// shading/grid.glsl: edges of the cells that samples stand for, as on graph paper: every one, every eighth, every 64th, and the
// edges of tiles (512), each family a little stronger. What would merge into grey fades.
#ifndef TERRAY_SHADING_GRID
#define TERRAY_SHADING_GRID
#include "shading/legend.glsl"
#include "shading/lines.glsl"

vec3 groundColour(NodeParameters node, vec4 hit, vec2 slope, vec2 position) {
    Footprint pixel = lineFootprint(node, hit, slope, position);
    vec2 perPixel = vec2(length(vec2(pixel.alongX.x, pixel.alongY.x)), length(vec2(pixel.alongX.y, pixel.alongY.y)));
    vec3 colour = legendColour(0xb9b4a6u);
    float cells = 1.0;
    for (int family = 0; family < 4; ++family) {
        float strong = float(family) / 3.0;
        float width = mix(1.0, 2.2, strong);
        float cover = max(lineCover(hit.x / cells, perPixel.x / cells, width),
                          lineCover(hit.y / cells, perPixel.y / cells, width));
        colour = mix(colour, legendColour(family == 3 ? 0x8c1d18u : 0x1d3b53u), cover * mix(0.55, 1.0, strong));
        cells *= 8.0;
    }
    return colour;
}

#endif
