// shading/lines.glsl: families of lines on the ground, of constant width in pixels. Anti-aliased by how fast a value changes
// from pixel to pixel, which the footprint tells: a compute shader has no derivatives.
#ifndef TERRAY_SHADING_LINES
#define TERRAY_SHADING_LINES
#include "pixel_footprint.glsl"

// Lines fade out where they lie closer together than this, pixels: wholly at the first, not at all at the second.
const float kMergedSpacing = 2.5;
const float kClearSpacing = 6.0;
// Ground on which a value changes by less than this from line to line of pixels is level: no line is drawn along its plateaus.
const float kLevel = 1e-6;
// Longest side of a footprint, texels: none of any use is longer.
const float kLongestLineFootprint = 1e6;

Footprint lineFootprint(NodeParameters node, vec4 hit, vec2 slope, vec2 position) {
    return footprintAt(node, hit, slope, position, kLongestLineFootprint);
}

// Part of a pixel, 0 .. 1, that the lines at whole numbers of a value cover.
// perPixel: length of the value's gradient on the screen, per pixel. width: of a line, pixels.
float lineCover(float value, float perPixel, float width) {
    if (perPixel < kLevel) return 0.0;
    float away = abs(fract(value + 0.5) - 0.5) / perPixel;
    float cover = clamp(0.5 + 0.5 * width - away, 0.0, 1.0);
    return cover * smoothstep(kMergedSpacing, kClearSpacing, 1.0 / perPixel);
}

#endif
