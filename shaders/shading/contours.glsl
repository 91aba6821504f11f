// shading/contours.glsl: lines of equal height of the dataset, whatever the exaggeration; every fifth is stronger.
#ifndef TERRAY_SHADING_CONTOURS
#define TERRAY_SHADING_CONTOURS
#include "shading/legend.glsl"
#include "shading/lines.glsl"
#include "shading/parameters.glsl"

vec3 groundColour(NodeParameters node, vec4 hit, vec2 slope, vec2 position) {
    Footprint pixel = lineFootprint(node, hit, slope, position);
    // Codes, then intervals, that the ground rises from pixel to pixel.
    vec2 rise = vec2(dot(slope, pixel.alongX), dot(slope, pixel.alongY));
    float perPixel = length(rise) * node.right.w * frame.air.z / shading.heights.z;
    float intervals = heightOfCode(node, hit.z) / shading.heights.z;
    float fine = 0.75 * lineCover(intervals, perPixel, 1.0);
    float strong = lineCover(intervals / 5.0, perPixel / 5.0, 1.8);
    return mix(mix(legendColour(0xe6e0d0u), legendColour(0x9a6231u), fine), legendColour(0x6b3a16u), strong);
}

#endif
