// shading/parameters.glsl: what shading modes measure by, as C++ wrote it.
#ifndef TERRAY_SHADING_PARAMETERS
#define TERRAY_SHADING_PARAMETERS
#include "interop.h"

layout(std140, binding = TERRAY_BUFFER_SHADING) uniform ShadingBuffer { ShadingParameters shading; };

#endif
