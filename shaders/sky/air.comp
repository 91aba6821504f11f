// sky/air.comp: aerial perspective's colour by direction and distance: that of endless air which, as far as to there, would send
// as much light as the air on this ray does. It is mixed with what is behind by the share that comes through.
#define TERRAY_SKY_READS_TRANSMITTANCE 1
#define TERRAY_SKY_READS_ECHO 1
#include "interop.h"
#include "sky/model.glsl"
#include "sky/place.glsl"
#include "sky/shown.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, rgba16f) writeonly uniform image3D table;

const int kStepsPerSlice = 3;

void main() {
    float sunSine = skyInput.view.x;
    float eyeHeight = skyInput.view.y;
    ivec3 size = imageSize(table);
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, size.xy))) return;

    vec2 angles = skyAngles(texel, size.xy, sky.shown.w);
    SkyRay ray = skyRay(eyeHeight, sin(angles.y), sunSine, angles.x);
    Air here = airAt(eyeHeight);
    vec3 colour = sourceAt(ray, 0.0, eyeHeight, here) / here.extinction;
    imageStore(table, ivec3(texel, 0), vec4(shownSky(colour), 1.0));
    Gathered gathered = Gathered(vec3(0.0), vec3(1.0));
    for (int slice = 1; slice < size.z; ++slice) {
        float start = sliceDistance(slice - 1, size.z);
        float end = sliceDistance(slice, size.z);
        for (int i = 0; i < kStepsPerSlice; ++i) {
            float from = mix(start, end, float(i) / float(kStepsPerSlice));
            gatherStep(gathered, ray, from, mix(start, end, float(i + 1) / float(kStepsPerSlice)));
        }
        colour = gathered.light / max(1.0 - gathered.through, vec3(1e-5));
        imageStore(table, ivec3(texel, slice), vec4(shownSky(colour), 1.0));
    }
}
