// sky/moment.glsl: the sky of this moment, as sky/expose.comp wrote it.
#ifndef TERRAY_SKY_MOMENT
#define TERRAY_SKY_MOMENT
#include "interop.h"

layout(std430, binding = TERRAY_BUFFER_SKY) readonly buffer SkyBuffer { SkyParameters sky; };

#endif
