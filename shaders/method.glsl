// method.glsl: the method that a program is compiled for (client/render/method.h). Each module offers
// March marchNode(NodeParameters node, vec3 direction): the first hit of a ray with a node's surface.
#ifndef TERRAY_METHOD
#define TERRAY_METHOD

#if TERRAY_METHOD_LINEAR
#include "methods/linear.glsl"
#elif TERRAY_METHOD_CONES
#include "methods/cones.glsl"
#else
#include "march.glsl"
#endif

#endif
