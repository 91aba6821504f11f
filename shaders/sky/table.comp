// sky/table.comp: what is seen in each direction of the sky from a height, as it is shown.
#define TERRAY_SKY_READS_TRANSMITTANCE 1
#define TERRAY_SKY_READS_ECHO 1
#include "interop.h"
#include "sky/model.glsl"
#include "sky/place.glsl"
#include "sky/shown.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, rgba16f) writeonly uniform image2D table;
layout(std430, binding = 0) readonly buffer LightBuffer { vec4 lights[]; };  // of light.comp

const int kSteps = 40;
const float kPi = 3.14159265;
// Ground beyond the end of the data: reflects as much as vegetation and rock do together. It is blended in from the horizon
// down to a depth; above, the sky behind the horizon shines through instead, so that nothing shows an edge.
const vec3 kGroundAlbedo = vec3(0.16, 0.17, 0.15);
const float kHazeDepth = 0.14;  // radians

void main() {
    float sunSine = skyInput.view.x;
    float eyeHeight = skyInput.view.y;
    ivec2 size = imageSize(table);
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, size))) return;

    vec2 angles = skyAngles(texel, size, sky.shown.w);
    float horizon = horizonCosine(eyeHeight);
    bool below = angles.y < sky.shown.w;
    vec3 light;
    if (!below) {
        SkyRay ray = skyRay(eyeHeight, max(sin(angles.y), horizon), sunSine, angles.x);
        light = gather(ray, spanToSpace(eyeHeight, ray.cosine), kSteps).light;
    } else {
        SkyRay ray = skyRay(eyeHeight, min(sin(angles.y), horizon), sunSine, angles.x);
        vec2 span = spanToSea(eyeHeight, ray.cosine);
        Gathered down = gather(ray, span, kSteps);
        float sunThere = cosineAlong(eyeHeight, span.y, sunSine, ray.between, 0.0);
        vec3 lit = sunAt(0.0, sunThere) * max(sunThere, 0.0) + lights[1].rgb;
        // The sky behind the horizon, as it is seen from there.
        SkyRay grazing = skyRay(eyeHeight, horizon, sunSine, angles.x);
        vec2 beyond = vec2(spanToSea(eyeHeight, horizon).y, spanToSpace(eyeHeight, horizon).y);
        vec3 behind = gather(grazing, beyond, kSteps).light;
        float deep = smoothstep(0.0, kHazeDepth, sky.shown.w - angles.y);
        light = down.light + down.through * mix(behind, lit * kGroundAlbedo / kPi, deep);
    }
    imageStore(table, texel, vec4(shownSky(light), 1.0));
}
