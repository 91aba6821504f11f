// resolve.comp: from hits to colours over the whole screen, for the compute launch.
#include "resolve.glsl"

layout(local_size_x = TERRAY_GROUP_SIDE, local_size_y = TERRAY_GROUP_SIDE) in;

#if TERRAY_SRGB_COLOUR
layout(binding = TERRAY_IMAGE_COLOUR, rgba8) writeonly uniform image2D colourImage;
#else
layout(binding = TERRAY_IMAGE_COLOUR, rgba16f) writeonly uniform image2D colourImage;
#endif
#if TERRAY_NORMALS
layout(binding = TERRAY_IMAGE_NORMAL, rgba32f) writeonly uniform image2D normalImage;
#endif

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(colourImage)))) return;
    Resolved resolved = resolvePixel(pixel);
    imageStore(colourImage, pixel, vec4(resolved.colour, 1.0));
#if TERRAY_NORMALS
    imageStore(normalImage, pixel, vec4(resolved.normal, 0.0));
#endif
}
