// methods/mesh_output.glsl: what the fragments of rasterised triangles write: where the pixel's ray is at their view depth.
#ifndef TERRAY_METHOD_MESH_OUTPUT
#define TERRAY_METHOD_MESH_OUTPUT
#include "nodes.glsl"

layout(location = TERRAY_UNIFORM_NODE) uniform uint nodeIndex;
#if TERRAY_STATISTICS
layout(binding = TERRAY_IMAGE_STEPS, r32ui) uniform coherent uimage2D stepImage;
#endif

layout(location = 0) out vec4 outHit;   // tile frame, and view depth in metres
layout(location = 1) out uint outNode;  // index + 1

vec4 fragmentHit(NodeParameters node) {
    float t = 1.0 / gl_FragCoord.w;
    return vec4(rayPoint(node, rayDirection(node, picturePosition(gl_FragCoord.xy)), t), t);
}

// A step is a fragment that was shaded.
void put(vec4 hit) {
#if TERRAY_STATISTICS
    imageAtomicAdd(stepImage, ivec2(gl_FragCoord.xy), 1u);
#endif
    outHit = hit;
    outNode = nodeIndex + 1u;
}

#endif
