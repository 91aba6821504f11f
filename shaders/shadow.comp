// shadow.comp: the part of the sun that each pixel's ground sees, over the whole screen, for the compute launch.
#include "shadow.glsl"

layout(local_size_x = TERRAY_GROUP_SIDE, local_size_y = TERRAY_GROUP_SIDE) in;

layout(binding = TERRAY_UNIT_HIT) uniform sampler2D hits;
layout(binding = TERRAY_UNIT_NODE) uniform usampler2D hitNodes;
layout(binding = TERRAY_IMAGE_SUN_LIGHT, r8) writeonly uniform image2D sunLightImage;
#if TERRAY_STATISTICS
layout(binding = TERRAY_IMAGE_SHADOW_STEPS, r32ui) writeonly uniform uimage2D shadowStepImage;
#endif

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(sunLightImage)))) return;
    uint found = texelFetch(hitNodes, pixel, 0).r;
    SunLight light = SunLight(1.0, 0u);
    if (found != 0u) light = sunLight(found - 1u, texelFetch(hits, pixel, 0).xyz, picturePixel(pixel));
#if TERRAY_STATISTICS
    imageStore(shadowStepImage, pixel, uvec4(light.steps));
#endif
    imageStore(sunLightImage, pixel, vec4(light.part));
}
