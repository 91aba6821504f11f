// shading.glsl: what the ground shows in place of its photo, by the one mode that is on (TERRAY_SHADE_...). Included with
// TERRAY_SHADING alone. Each mode defines, as photo.glsl does, the linear colour
//     vec3 groundColour(NodeParameters node, vec4 hit, vec2 slope, vec2 position)
// hit: tile frame, and view depth in metres. slope: gradient of the surface, codes per texel. position: on the picture,
// -1 .. 1. With TERRAY_UNLIT it is what is seen, else the colour of ground that is lit as ever.
// Source: paper 000, section 3.8 and figure 8.
#ifndef TERRAY_SHADING_MODES
#define TERRAY_SHADING_MODES
#if TERRAY_SHADE_HEIGHT
#include "shading/height.glsl"
#elif TERRAY_SHADE_DEPTH
#include "shading/depth.glsl"
#elif TERRAY_SHADE_LEVEL
#include "shading/level.glsl"
#elif TERRAY_SHADE_GRID
#include "shading/grid.glsl"
#elif TERRAY_SHADE_NORMAL
#include "shading/normal.glsl"
#elif TERRAY_SHADE_SLOPE
#include "shading/slope.glsl"
#elif TERRAY_SHADE_CONTOURS
#include "shading/contours.glsl"
#elif TERRAY_SHADE_TILES
#include "shading/tiles.glsl"
#elif TERRAY_SHADE_RESIDENCY
#include "shading/residency.glsl"
#elif TERRAY_SHADE_ERROR
#include "shading/error.glsl"
#elif TERRAY_SHADE_SOBEL
#include "shading/sobel.glsl"
#else
#include "shading/steps.glsl"
#endif
#endif
