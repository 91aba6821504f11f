// sky/echo.comp: light that was scattered at least twice, by height and the sun's zenith angle (Hillaire 2020, section 5.5).
// Scattering beyond the first is taken as equal in all directions and as fed by surroundings like this place's own: then all
// orders are a geometric series, second order / (1 - share that comes back). One work group makes one texel, each of its
// threads one direction.
#define TERRAY_SKY_READS_TRANSMITTANCE 1
#define TERRAY_SKY_READS_ECHO 0
#include "interop.h"
#include "sky/model.glsl"

layout(local_size_x = 64) in;
layout(binding = 0, rgba32f) writeonly uniform image2D table;

const int kSteps = 20;
const float kPi = 3.14159265;
const float kGroundAlbedo = 0.2;

shared vec3 secondOrder[64];
shared vec3 comingBack[64];

void main() {
    ivec2 texel = ivec2(gl_WorkGroupID.xy);
    int thread = int(gl_LocalInvocationIndex);

    // The inverse of echoPlace().
    vec2 place = vec2(texel) / vec2(imageSize(table) - 1);
    float height = max(kAirTop * place.y * place.y, 1.0);
    float side = 2.0 * place.x - 1.0;
    float cosSun = sign(side) * side * side;

    // 8 x 8 directions of equal solid angle.
    float cosine = 1.0 - 2.0 * (float(thread / 8) + 0.5) / 8.0;
    float azimuth = 2.0 * kPi * (float(thread % 8) + 0.5) / 8.0;
    float between = cosine * cosSun + sqrt(max((1.0 - cosine * cosine) * (1.0 - cosSun * cosSun), 0.0)) * cos(azimuth);
    bool meetsSea = cosine < horizonCosine(height);
    float reach = meetsSea ? seaDistance(height, cosine) : leavingDistance(height, cosine, kAirTop);

    vec3 light = vec3(0.0);
    vec3 returned = vec3(0.0);
    vec3 through = vec3(1.0);
    for (int i = 0; i < kSteps; ++i) {
        float start = reach * stepPlace(height, float(i) / float(kSteps));
        float end = reach * stepPlace(height, float(i + 1) / float(kSteps));
        float middle = 0.5 * (start + end);
        float here = max(heightAlong(height, cosine, middle), 0.0);
        float sunHere = cosineAlong(height, middle, cosSun, between, here);
        Air air = airAt(here);
        vec3 depth = air.extinction * (end - start);
        vec3 share = through * (end - start) * vec3(meanDecay(depth.r), meanDecay(depth.g), meanDecay(depth.b)) *
                     (air.molecules + air.aerosol);
        light += share * sunAt(here, sunHere) / (4.0 * kPi);
        returned += share;
        through *= exp(-depth);
    }
    if (meetsSea) {
        float sunThere = cosineAlong(height, reach, cosSun, between, 0.0);
        light += through * sunAt(0.0, sunThere) * max(sunThere, 0.0) * kGroundAlbedo / kPi;
    }
    secondOrder[thread] = light;
    comingBack[thread] = returned;
    barrier();

    if (thread > 0) return;
    vec3 sumLight = vec3(0.0);
    vec3 sumBack = vec3(0.0);
    for (int i = 0; i < 64; ++i) {
        sumLight += secondOrder[i];
        sumBack += comingBack[i];
    }
    imageStore(table, texel, vec4(sumLight / 64.0 / (1.0 - sumBack / 64.0), 1.0));
}
