// methods/hull_output.glsl: what the fragments of the pushed-up mesh write.
#ifndef TERRAY_METHOD_HULL_OUTPUT
#define TERRAY_METHOD_HULL_OUTPUT
#include "methods/hull.glsl"

layout(location = TERRAY_UNIFORM_NODE) uniform uint nodeIndex;
#if TERRAY_STATISTICS
layout(binding = TERRAY_IMAGE_STEPS, r32ui) uniform coherent uimage2D stepImage;
#endif

layout(location = 0) out vec4 outHit;   // tile frame, and view depth in metres
layout(location = 1) out uint outNode;  // index + 1

// Searches from a view depth on, metres.
void castFrom(NodeParameters node, vec3 direction, float start) {
    March march = searchBelow(node, direction, start);
#if TERRAY_STATISTICS
    imageAtomicAdd(stepImage, ivec2(gl_FragCoord.xy), uint(march.steps));
#endif
    if (!march.hit) discard;
    outHit = vec4(rayPoint(node, direction, march.t), march.t);
    outNode = nodeIndex + 1u;
    gl_FragDepth = frame.forward.w / max(march.t, frame.forward.w);  // t may be 0, of either sign
}

#endif
