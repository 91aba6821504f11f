// sky/light.comp: sunlight and skylight on the ground at the heights of the table of lights, per unit of sunlight above the
// air. One work group for each height, each of its threads one direction of the sky.
#define TERRAY_SKY_READS_TRANSMITTANCE 1
#define TERRAY_SKY_READS_ECHO 1
#include "interop.h"
#include "sky/model.glsl"

layout(local_size_x = 64) in;
layout(std430, binding = 0) writeonly buffer LightBuffer { vec4 lights[]; };  // sun, then sky, at each height

const int kSteps = 24;
const float kPi = 3.14159265;

shared vec3 radiance[64];

void main() {
    float sunSine = skyInput.view.x;
    int thread = int(gl_LocalInvocationIndex);
    uint level = gl_WorkGroupID.x;
    float height = max(TERRAY_SKY_TOP_LIGHT * float(level) / float(TERRAY_SKY_LIGHTS - 1), 1.0);

    // 8 x 8 directions, each standing for as much of the light on level ground; the sky is alike on both sides of the sun.
    float cosine = sqrt((float(thread / 8) + 0.5) / 8.0);
    float azimuth = kPi * (float(thread % 8) + 0.5) / 8.0;
    SkyRay ray = skyRay(height, cosine, sunSine, azimuth);
    radiance[thread] = gather(ray, spanToSpace(height, cosine), kSteps).light;
    barrier();

    if (thread > 0) return;
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 64; ++i) sum += radiance[i];
    lights[2u * level] = vec4(sunAt(height, sunSine), 0.0);
    lights[2u * level + 1u] = vec4(kPi * sum / 64.0, 0.0);
}
