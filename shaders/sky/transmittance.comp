// sky/transmittance.comp: the share of light that comes through the air from a place to space, by height and zenith angle.
#define TERRAY_SKY_READS_TRANSMITTANCE 0
#define TERRAY_SKY_READS_ECHO 0
#include "interop.h"
#include "sky/model.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, rgba32f) writeonly uniform image2D table;

const int kSteps = 64;

void main() {
    ivec2 size = imageSize(table);
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, size))) return;

    // The inverse of transmittancePlace().
    vec2 place = vec2(texel) / vec2(size - 1);
    float height = kAirTop * place.y * place.y;
    float horizon = horizonCosine(height);
    float cosine = horizon + (1.0 - horizon) * place.x * place.x;

    float reach = leavingDistance(height, cosine, kAirTop);
    vec3 depth = vec3(0.0);
    for (int i = 0; i < kSteps; ++i) {
        float start = reach * stepPlace(height, float(i) / float(kSteps));
        float end = reach * stepPlace(height, float(i + 1) / float(kSteps));
        depth += airAt(max(heightAlong(height, cosine, 0.5 * (start + end)), 0.0)).extinction * (end - start);
    }
    imageStore(table, texel, vec4(exp(-depth), 1.0));
}
