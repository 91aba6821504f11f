// sky/model.glsl: light in the air above a spherical earth, per unit of sunlight above the air: what of the sun reaches a
// place, what the air around it sends back, and what a ray gathers on its way.
// Frame and units: math/atmosphere.glsl. Sources: Bruneton and Neyret 2008, "Precomputed atmospheric scattering"
// (doi 10.1111/j.1467-8659.2008.01245.x), for the tables' idea; Hillaire 2020, "A scalable and production ready sky and
// atmosphere rendering technique" (doi 10.1111/cgf.14050), for scattering beyond the first.
#ifndef TERRAY_SKY_MODEL
#define TERRAY_SKY_MODEL
#include "interop.h"
#include "math/air.glsl"
#include "math/atmosphere.glsl"

layout(std140, binding = TERRAY_BUFFER_SKY_INPUT) uniform SkyInputBuffer { SkyInput skyInput; };

// What a metre of air does to light; 1/m.
struct Air {
    vec3 molecules;   // scattered by molecules
    vec3 aerosol;     // scattered by aerosol
    vec3 extinction;  // scattered and absorbed by all
};

Air airAt(float height) {
    vec3 molecules = kMolecules * moleculeDensity(height);
    vec3 aerosol = aerosolExtinction(skyInput.air.x) * aerosolDensity(height);
    return Air(molecules, aerosol * kAerosolAlbedo, molecules + aerosol + kOzone * ozoneDensity(height));
}

// Distance along a ray at a share of it, 0 .. 1: short steps at the eye's end, where the air is mostly dense; even ones
// when the eye is far above it.
float stepPlace(float height, float share) { return height < 30000.0 ? share * share : share; }

// Position in the table of transmittances, 0 .. 1: fine near the horizon and near the ground.
vec2 transmittancePlace(float height, float cosine) {
    float horizon = horizonCosine(height);
    return vec2(sqrt(clamp((cosine - horizon) / (1.0 - horizon), 0.0, 1.0)), sqrt(clamp(height / kAirTop, 0.0, 1.0)));
}
// Position in the table of echoes, 0 .. 1: fine for a sun near the horizon, and near the ground.
vec2 echoPlace(float height, float cosSun) {
    return vec2(0.5 + 0.5 * sign(cosSun) * sqrt(abs(cosSun)), sqrt(clamp(height / kAirTop, 0.0, 1.0)));
}
// Texture coordinate of a position, so that 0 and 1 are the centres of the outermost texels.
vec2 texelPlace(vec2 place, vec2 size) { return (0.5 + place * (size - 1.0)) / size; }

#if TERRAY_SKY_READS_TRANSMITTANCE
layout(binding = TERRAY_SKY_UNIT_TRANSMITTANCE) uniform sampler2D transmittances;

// From a place to space. A direction below the horizon counts as the horizon.
vec3 transmittanceToSpace(float height, float cosine) {
    vec2 place = transmittancePlace(height, cosine);
    return texture(transmittances, texelPlace(place, vec2(textureSize(transmittances, 0)))).rgb;
}

// The sun's light at a place, on a surface that faces it: what the air lets through, of the part of the disc that is above
// the horizon.
vec3 sunAt(float height, float cosSun) {
    float above = smoothstep(-kSunRadius, kSunRadius, cosSun - horizonCosine(height));
    return above > 0.0 ? above * transmittanceToSpace(height, cosSun) : vec3(0.0);
}
#endif

#if TERRAY_SKY_READS_ECHO
layout(binding = TERRAY_SKY_UNIT_ECHO) uniform sampler2D echoes;

// Radiance of light that has been scattered more than once, the same from all sides.
vec3 echoAt(float height, float cosSun) {
    return texture(echoes, texelPlace(echoPlace(height, cosSun), vec2(textureSize(echoes, 0)))).rgb;
}

// A ray from the eye: its height, and cosines of the zenith angles of ray and sun there, and of the angle between both.
struct SkyRay {
    float height;
    float cosine;
    float cosSun;
    float between;
};

// azimuth: of the ray from the sun.
SkyRay skyRay(float height, float cosine, float cosSun, float azimuth) {
    float level = sqrt(max((1.0 - cosine * cosine) * (1.0 - cosSun * cosSun), 0.0));
    return SkyRay(height, cosine, cosSun, clamp(cosine * cosSun + level * cos(azimuth), -1.0, 1.0));
}

// Light gathered along a ray, and what of the light behind comes through.
struct Gathered {
    vec3 light;
    vec3 through;
};

// Light that a metre of the air at a distance sends along the ray.
vec3 sourceAt(SkyRay ray, float distance, float height, Air air) {
    float cosSun = cosineAlong(ray.height, distance, ray.cosSun, ray.between, height);
    vec3 first = air.molecules * moleculePhase(ray.between) + air.aerosol * aerosolPhase(ray.between);
    return sunAt(height, cosSun) * first + echoAt(height, cosSun) * (air.molecules + air.aerosol);
}

// Goes on along a ray from start to end, metres. Below the sea the air is as on it.
void gatherStep(inout Gathered gathered, SkyRay ray, float start, float end) {
    float middle = 0.5 * (start + end);
    float here = max(heightAlong(ray.height, ray.cosine, middle), 0.0);
    Air air = airAt(here);
    // Within a step the source is constant and the light decays.
    vec3 depth = air.extinction * (end - start);
    vec3 decay = vec3(meanDecay(depth.r), meanDecay(depth.g), meanDecay(depth.b));
    gathered.light += gathered.through * sourceAt(ray, middle, here, air) * (end - start) * decay;
    gathered.through *= exp(-depth);
}

Gathered gather(SkyRay ray, vec2 fromTo, int steps) {
    Gathered gathered = Gathered(vec3(0.0), vec3(1.0));
    float reach = fromTo.y - fromTo.x;
    for (int i = 0; i < steps; ++i) {
        float start = fromTo.x + reach * stepPlace(ray.height, float(i) / float(steps));
        float end = fromTo.x + reach * stepPlace(ray.height, float(i + 1) / float(steps));
        gatherStep(gathered, ray, start, end);
    }
    return gathered;
}

// Where a ray that meets no ground runs through the air; an empty span when it does not.
vec2 spanToSpace(float height, float cosine) {
    if (height <= kAirTop) return vec2(0.0, leavingDistance(height, cosine, kAirTop));
    float enter = enteringDistance(height, cosine, kAirTop);
    if (enter < 0.0) return vec2(0.0);
    // It leaves as far beyond its lowest point as it entered before.
    return vec2(enter, -2.0 * (kEarthRadius + height) * cosine - enter);
}
// Where a ray that meets the sea runs through the air.
vec2 spanToSea(float height, float cosine) {
    float enter = height <= kAirTop ? 0.0 : max(enteringDistance(height, cosine, kAirTop), 0.0);
    return vec2(enter, seaDistance(height, cosine));
}
#endif

#endif
