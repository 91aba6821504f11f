// sky/expose.comp: from physical light to what pictures show: how bright the scene is taken, and the light on the ground at
// each height, relative to the same under a sun at 40 degrees, where daylight.glsl says how ground looks.
#define TERRAY_SKY_READS_TRANSMITTANCE 1
#define TERRAY_SKY_READS_ECHO 0
#include "daylight.glsl"
#include "interop.h"
#include "sky/model.glsl"

layout(local_size_x = TERRAY_SKY_LIGHTS) in;
layout(std430, binding = 0) readonly buffer LightBuffer { vec4 lights[]; };       // of light.comp
layout(std430, binding = 1) readonly buffer ReferenceBuffer { vec4 reference[]; };  // likewise, sun at 40 degrees
layout(std430, binding = TERRAY_BUFFER_SKY) writeonly buffer SkyBuffer { SkyParameters sky; };

const float kPi = 3.14159265;
// sin(40 degrees)
const float kReferenceSine = 0.6427876;
// The sky is shown this much brighter than a white ground under the same light would make it, as in photographs.
const float kSkyGain = 2.0;
// Eyes and cameras make up for most of the dark: of the sky's light, relative to that under a sun at 40 degrees, pictures show
// the power 0.16, and the power 0.3 below a hundredth of daylight or so (kDusk), where the sun is some 5 degrees below the
// horizon: from there on it shall look like night. They adapt no further than to kDarkest times the light of the night, so
// that the sky does not brighten again while the last glow goes. A range of 1e5 becomes one of 40.
const float kByDay = 0.16;
const float kByNight = 0.3;
const float kDusk = 3e-3;
const float kDarkest = 5.0;
// Light of a clear night with a moon, relative to daylight at 40 degrees (0.07 to 70000 lux), with the cold tint in which
// eyes see it.
const vec3 kNight = 1e-6 * vec3(0.6, 0.85, 1.6);
// Brightest that the sun's disc is drawn: enough to be white by day, little enough to show its colour near the horizon.
const float kBrightestDisc = 6.0;

float luminance(vec3 colour) { return dot(colour, vec3(0.2126, 0.7152, 0.0722)); }

void main() {
    float sunSine = skyInput.view.x;
    float eyeHeight = skyInput.view.y;
    uint level = gl_LocalInvocationIndex;
    vec3 daylight = reference[0].rgb * kReferenceSine + reference[1].rgb;  // on level ground at sea level
    vec3 night = kNight * luminance(daylight);
    float dimming = luminance(lights[1].rgb + kDarkest * night) / luminance(reference[1].rgb);
    float exposure = pow(dimming, kByDay - 1.0) * pow(1.0 + kDusk / dimming, kByDay - kByNight);

    vec3 sunShare = lights[2u * level].rgb / reference[2u * level].rgb;
    vec3 skyShare = (lights[2u * level + 1u].rgb + night) / reference[2u * level + 1u].rgb;
    sky.sunLight[level] = vec4(kSunLight * sunShare * exposure, 0.0);
    sky.skyLight[level] = vec4(kSkyLight * skyShare * exposure, 0.0);
    if (level > 0u) return;

    // White balance: level ground under that light is shown with its own colour.
    vec3 shown = kSkyGain * exposure * kPi / daylight;
    vec3 disc = transmittanceToSpace(eyeHeight, sunSine) * shown / (kPi * kSunRadius * kSunRadius);
    float brightest = max(disc.r, max(disc.g, disc.b));
    sky.disc = vec4(disc * min(1.0, kBrightestDisc / max(brightest, 1e-30)), 0.0);
    sky.shown = vec4(shown, asin(horizonCosine(eyeHeight)));
    sky.night = vec4(night / kPi, 0.0);
}
