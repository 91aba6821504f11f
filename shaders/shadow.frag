// shadow.frag: the part of the sun that each pixel's ground sees, over the whole screen, for the raster launch.
#include "shadow.glsl"

layout(binding = TERRAY_UNIT_HIT) uniform sampler2D hits;
layout(binding = TERRAY_UNIT_NODE) uniform usampler2D hitNodes;
#if TERRAY_STATISTICS
layout(binding = TERRAY_IMAGE_SHADOW_STEPS, r32ui) writeonly uniform uimage2D shadowStepImage;
#endif

layout(location = 0) out float outSunLight;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uint found = texelFetch(hitNodes, pixel, 0).r;
    SunLight light = SunLight(1.0, 0u);
    if (found != 0u) light = sunLight(found - 1u, texelFetch(hits, pixel, 0).xyz, picturePixel(pixel));
#if TERRAY_STATISTICS
    imageStore(shadowStepImage, pixel, uvec4(light.steps));
#endif
    outSunLight = light.part;
}
