// photo.glsl: colour of the ground. With TERRAY_IMAGERY the photo, sampled anisotropically over the pixel's footprint with
// explicit gradients (paper 001, section 3.3); without, or where there is no photo, the neutral ground.
#ifndef TERRAY_PHOTO
#define TERRAY_PHOTO
#include "nodes.glsl"

#if TERRAY_IMAGERY
#include "math/footprint.glsl"

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

// slope: gradient of the surface as seen from the eye (seenSlope), codes per texel. t: view depth, metres. position: on the picture, -1 .. 1.
vec3 groundColour(NodeParameters node, vec2 texel, vec2 slope, float t, vec2 position) {
    if (node.source.y == TERRAY_NO_SLOT) return frame.ground.rgb;

    // The texel vectors (1, 0) and (0, 1), lifted onto the tangent plane, in metres and then in camera axes.
    vec3 east = vec3(node.eye.w, 0.0, slope.x * node.right.w);
    vec3 south = vec3(0.0, -node.eye.w, slope.y * node.right.w);
    vec2 halfPicture = vec2(length(frame.right.xyz), length(frame.up.xyz));
    vec3 right = frame.right.xyz / halfPicture.x;
    vec3 up = frame.up.xyz / halfPicture.y;
    vec3 eastView = vec3(dot(east, right), dot(east, up), dot(east, frame.forward.xyz));
    vec3 southView = vec3(dot(south, right), dot(south, up), dot(south, frame.forward.xyz));
    float focal = 0.5 * frame.up.w / halfPicture.y;
    vec2 raySlope = position * halfPicture;

    Footprint pixel = pixelFootprint(projected(eastView, raySlope, t, focal), projected(southView, raySlope, t, focal),
                                     kLongestFootprint / node.photo.z);
    vec2 uv = (node.photo.xy + node.photo.z * texel + kPhotoGutter) / kPhotoSide;
    float perTexel = node.photo.z / kPhotoSide;
    return filteredPhoto(vec3(uv, float(node.source.y)), pixel.alongX * perTexel, pixel.alongY * perTexel);
}
#else
vec3 groundColour(NodeParameters node, vec2 texel, vec2 slope, float t, vec2 position) { return frame.ground.rgb; }
#endif

#endif
