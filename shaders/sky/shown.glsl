// sky/shown.glsl: from the radiance of sky or air, per unit of sunlight above the air, to the colour that is shown.
#ifndef TERRAY_SKY_SHOWN
#define TERRAY_SKY_SHOWN
#include "sky/moment.glsl"

// The sky's range is far beyond what is shown. From kLinear on brightness grows by its logarithm and keeps its hue; below kEnd
// each colour ends softly, so that only the surroundings of the sun go through yellow to white and its disc is brighter still.
vec3 compressed(vec3 colour) {
    const float kLinear = 0.55;
    const float kLogarithmic = 0.16;
    const float kSoft = 0.75;
    const float kEnd = 0.92;
    float brightest = max(max(colour.r, max(colour.g, colour.b)), 1e-30);
    float over = max(brightest - kLinear, 0.0);
    colour *= (min(brightest, kLinear) + kLogarithmic * log(1.0 + over / kLogarithmic)) / brightest;
    vec3 beyond = max(colour - kSoft, 0.0) / (kEnd - kSoft);
    return min(colour, kSoft) + (kEnd - kSoft) * (1.0 - exp(-beyond));
}

vec3 shownSky(vec3 light) { return compressed((light + sky.night.rgb) * sky.shown.rgb); }

#endif
