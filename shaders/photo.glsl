// photo.glsl: colour of the ground. With TERRAY_IMAGERY the photo, sampled anisotropically over the pixel's footprint with
// explicit gradients (paper 001, section 3.3); without, or where there is no photo, the neutral ground.
#ifndef TERRAY_PHOTO
#define TERRAY_PHOTO
#include "nodes.glsl"

#if TERRAY_IMAGERY
#include "pixel_footprint.glsl"

layout(binding = TERRAY_UNIT_PHOTO) uniform sampler2DArray photos;

const float kPhotoCore = 512.0;
const float kPhotoGutter = 32.0;
const float kPhotoSide = 576.0;
// Footprints longer than this many photo texels blur no further: 16 samples of the coarsest of 4 mips.
const float kLongestFootprint = 128.0;

// The photo over a footprint given by two vectors in texture coordinates.
#if TERRAY_PHOTO_PROBES
// Anisotropic filtering in the shader: probes along the longer vector, each isotropic. For rasterisers whose own is slow.
// Source: EXT_texture_filter_anisotropic, "Texture Anisotropic Filtering"; a shorter side below a texel counts as one.
vec3 filteredPhoto(vec3 place, vec2 alongX, vec2 alongY) {
    float lengthX = length(alongX) * kPhotoSide;
    float lengthY = length(alongY) * kPhotoSide;
    vec2 longer = lengthX > lengthY ? alongX : alongY;
    float longest = max(max(lengthX, lengthY), 1.0);
    float probes = min(ceil(longest / max(min(lengthX, lengthY), 1.0)), frame.viewScale.z);
    float level = log2(longest / probes);
    vec3 sum = vec3(0.0);
    for (float i = 1.0; i <= probes; i += 1.0)
        sum += textureLod(photos, vec3(place.xy + (i / (probes + 1.0) - 0.5) * longer, place.z), level).rgb;
    return sum / probes;
}
#else
vec3 filteredPhoto(vec3 place, vec2 alongX, vec2 alongY) { return textureGrad(photos, place, alongX, alongY).rgb; }
#endif

// hit: tile frame, and view depth in metres. slope: gradient of the surface, codes per texel. position: on the picture, -1 .. 1.
vec3 photoColour(NodeParameters node, vec4 hit, vec2 slope, vec2 position) {
    if (node.source.y == TERRAY_NO_SLOT) return frame.ground.rgb;
    Footprint pixel = footprintAt(node, hit, slope, position, kLongestFootprint / node.photo.z);
    vec2 uv = (node.photo.xy + node.photo.z * hit.xy + kPhotoGutter) / kPhotoSide;
    float perTexel = node.photo.z / kPhotoSide;
    return filteredPhoto(vec3(uv, float(node.source.y)), pixel.alongX * perTexel, pixel.alongY * perTexel);
}
#else
vec3 photoColour(NodeParameters node, vec4 hit, vec2 slope, vec2 position) { return frame.ground.rgb; }
#endif

#endif
