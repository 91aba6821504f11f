// sky.glsl: what a ray that meets no ground sees; linear. Directions and sun: unit, world.
// With TERRAY_SKY the sky of the sun's elevation and the eye's height, from the table that sky/table.comp made. Without, a
// gradient by elevation, hazy below the horizon, with a bright sun.
// With TERRAY_SIGNAL_SKY a colour that no ground has, so that tests can count pixels without ground.
#ifndef TERRAY_SKY_COLOUR
#define TERRAY_SKY_COLOUR

#if TERRAY_SKY
#include "math/atmosphere.glsl"
#include "nodes.glsl"
#include "sky/moment.glsl"
#include "sky/place.glsl"

layout(binding = TERRAY_UNIT_SKY) uniform sampler2D skyTable;
#if TERRAY_AIR
layout(binding = TERRAY_UNIT_AIR) uniform sampler3D airTable;
#endif

// Texture coordinate of a direction in either table.
vec2 directionPlace(vec3 direction, vec3 sun, vec2 size) {
    float across = abs(direction.x * sun.y - direction.y * sun.x);
    float along = dot(direction.xy, sun.xy);
    // Straight up and down all azimuths are alike.
    float azimuth = across == 0.0 && along == 0.0 ? 0.0 : atan(across, along);
    return skyPlace(azimuth, asin(clamp(direction.z, -1.0, 1.0)), size, sky.shown.w);
}

// A colour with the sun over it as far as that is above the horizon: its disc, darker towards its limb, and the glare around
// it in air and lens. Source of the limb: Hestroffer and Magnan 1998, "Wavelength dependency of the solar limb darkening":
// intensity mu^a with a = 0.292 / micrometres - 0.023. The glare is a look, of no source.
vec3 withSun(vec3 colour, vec3 direction, vec3 sun) {
    const vec3 kLimb = vec3(0.438, 0.515, 0.638);
    const float kGlare = 0.3;
    const float kGlareEnd = 0.14;  // radians
    float away = length(cross(direction, sun));  // sine of the angle from the centre
    if (dot(direction, sun) < 0.0 || away > kGlareEnd) return colour;
    float horizon = sin(sky.shown.w);
    float near = kSunRadius / (kSunRadius + away);
    float end = kSunRadius / (kSunRadius + kGlareEnd);
    float risen = smoothstep(-kSunRadius, kSunRadius, sun.z - horizon);
    colour = mix(vec3(1.0), colour, exp(-sky.disc.rgb * (kGlare * risen * (near * near - end * end))));

    float pixel = 2.0 * length(frame.up.xyz) / frame.up.w;  // angle of a pixel on the view axis
    float inside = clamp((kSunRadius - away) / pixel + 0.5, 0.0, 1.0);
    float above = clamp((direction.z - horizon) / pixel + 0.5, 0.0, 1.0);
    float part = min(away / kSunRadius, 0.999);
    // Far too bright to be shown: each colour ends softly, so that a low sun goes from yellow to red.
    vec3 disc = 1.0 - exp(-sky.disc.rgb * pow(vec3(sqrt(1.0 - part * part)), kLimb));
    return mix(colour, max(colour, disc), inside * above);
}
#endif

#if !TERRAY_SKY
const vec3 kHorizon = vec3(0.62, 0.73, 0.85);

// The sun's glow in the air around it.
vec3 sunGlow(float towardsSun) { return vec3(1.0, 0.9, 0.7) * (0.18 * pow(max(towardsSun, 0.0), 32.0)); }
#endif

#if TERRAY_SIGNAL_SKY
vec3 skyColour(vec3 direction, vec3 sun) { return vec3(1.0, 0.0, 1.0); }
#elif TERRAY_SKY
vec3 skyColour(vec3 direction, vec3 sun) {
    vec2 place = directionPlace(direction, sun, vec2(textureSize(skyTable, 0)));
    return withSun(textureLod(skyTable, place, 0.0).rgb, direction, sun);
}
#else
vec3 skyColour(vec3 direction, vec3 sun) {
    const vec3 kZenith = vec3(0.13, 0.29, 0.60);
    const vec3 kBelow = vec3(0.49, 0.56, 0.64);
    float elevation = direction.z;
    vec3 above = mix(kHorizon, kZenith, pow(clamp(elevation, 0.0, 1.0), 0.55));
    vec3 gradient = mix(above, kBelow, smoothstep(0.0, -0.12, elevation));
    float towardsSun = dot(direction, sun);
    return gradient + sunGlow(towardsSun) + vec3(1.0, 0.9, 0.7) * (2.0 * smoothstep(0.99996, 0.99999, towardsSun));
}
#endif

#if TERRAY_AIR
// Colour of endless air like that in a direction as far as to a distance.
#if TERRAY_SKY
vec3 airlight(vec3 direction, vec3 sun, float distance) {
    vec3 size = vec3(textureSize(airTable, 0));
    return textureLod(airTable, vec3(directionPlace(direction, sun, size.xy), slicePlace(distance, size.z)), 0.0).rgb;
}
#else
vec3 airlight(vec3 direction, vec3 sun, float distance) { return kHorizon + sunGlow(dot(direction, sun)); }
#endif
#endif

#endif
