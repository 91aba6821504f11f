// shading/steps.glsl: how many steps a pixel's ray took over all nodes, or its shadow rays; for the sky's pixels too.
// Source: Dick, Krueger, Westermann 2009, figure 6: from black for 0 to white for 50 steps; paper 000, figure 11, likewise.
#ifndef TERRAY_SHADING_STEPS
#define TERRAY_SHADING_STEPS
#include "nodes.glsl"
#include "shading/legend.glsl"

const uint kStepStops[kStops] = uint[](0x000000u, 0x2b1060u, 0x8c1f6au, 0xd8413fu, 0xf58a2eu, 0xfad55cu, 0xffffffu);
const float kWhiteSteps = 50.0;

// Without shadows, as while the sun is below the horizon, no shadow ray takes a step.
#if TERRAY_SHADE_STEPS || TERRAY_SHADOWS
layout(binding = TERRAY_UNIT_STEPS) uniform usampler2D stepCounts;

uint stepsAt(ivec2 pixel) { return texelFetch(stepCounts, pixel, 0).r & 0x7fffffffu; }
#else
uint stepsAt(ivec2 pixel) { return 0u; }
#endif

vec3 stepColour(ivec2 pixel) { return rampColour(kStepStops, float(stepsAt(pixel)) * float(kStops - 1) / kWhiteSteps); }

// Seen of no pixel: ground and sky alike have the colour of their steps.
vec3 groundColour(NodeParameters node, vec4 hit, vec2 slope, vec2 position) { return vec3(0.0); }

#endif
