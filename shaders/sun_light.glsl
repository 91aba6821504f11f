// sun_light.glsl: the part of the sun that a pixel's ground sees, 0 .. 1, as the shadow pass left it; all without shadows.
#ifndef TERRAY_SUN_LIGHT
#define TERRAY_SUN_LIGHT
#include "interop.h"

#if TERRAY_SHADOWS
layout(binding = TERRAY_UNIT_SUN_LIGHT) uniform sampler2D sunLights;

float sunLightAt(ivec2 pixel) { return texelFetch(sunLights, pixel, 0).r; }
#else
float sunLightAt(ivec2 pixel) { return 1.0; }
#endif

#endif
