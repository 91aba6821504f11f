// light.glsl: sun and sky on matt ground; linear. With TERRAY_UNLIT colours are shown as they are.
// With TERRAY_SKY both follow the sun's elevation and the height of the ground: redder and dimmer while it sinks, a while
// longer on the summits.
#ifndef TERRAY_LIGHT
#define TERRAY_LIGHT
#include "daylight.glsl"
#if TERRAY_SKY
#include "sky/moment.glsl"
#endif

struct Light {
    vec3 sun;  // on ground that faces it
    vec3 sky;  // on level ground
};

// height: of the ground above the sea, metres.
#if TERRAY_SKY
Light lightAt(float height) {
    float place = clamp(height / TERRAY_SKY_TOP_LIGHT, 0.0, 1.0) * float(TERRAY_SKY_LIGHTS - 1);
    int below = min(int(place), TERRAY_SKY_LIGHTS - 2);
    float above = place - float(below);
    return Light(mix(sky.sunLight[below].rgb, sky.sunLight[below + 1].rgb, above),
                 mix(sky.skyLight[below].rgb, sky.skyLight[below + 1].rgb, above));
}
#else
Light lightAt(float height) { return Light(kSunLight, kSkyLight); }
#endif

// sunPart: of the sun that is seen, 0 .. 1. Sky light falls off to half on a vertical wall, which sees half of the sky.
#if TERRAY_UNLIT
vec3 lit(vec3 colour, vec3 normal, vec3 sun, Light light, float sunPart) { return colour; }
#else
vec3 lit(vec3 colour, vec3 normal, vec3 sun, Light light, float sunPart) {
    return colour * (light.sun * (sunPart * max(dot(normal, sun), 0.0)) + light.sky * (0.5 + 0.5 * normal.z));
}
#endif

#endif
