// march.frag: casts the rays of one node. Drawn over the back faces of its box; a pixel that the ID pass did not give to
// this node is left before the loop (paper 001, section 3.4).
#include "method.glsl"

layout(location = TERRAY_UNIFORM_NODE) uniform uint nodeIndex;
#if TERRAY_OCCLUSION
layout(binding = TERRAY_UNIT_ID) uniform usampler2D nodeInFront;
#endif
#if TERRAY_STATISTICS
layout(binding = TERRAY_IMAGE_STEPS, r32ui) uniform coherent uimage2D stepImage;
#endif

layout(location = 0) out vec4 outHit;   // tile frame, and view depth in metres
layout(location = 1) out uint outNode;  // index + 1

void main() {
#if TERRAY_OCCLUSION
    if (texelFetch(nodeInFront, ivec2(gl_FragCoord.xy), 0).r != nodeIndex + 1u) discard;
#endif
    NodeParameters node = nodes[nodeIndex];
    vec3 direction = rayDirection(node, picturePosition(gl_FragCoord.xy));
    March march = marchNode(node, direction);
#if TERRAY_STATISTICS
    imageAtomicAdd(stepImage, ivec2(gl_FragCoord.xy), uint(march.steps));
    if (march.exhausted) imageAtomicOr(stepImage, ivec2(gl_FragCoord.xy), 0x80000000u);
#endif
    if (!march.hit) discard;
    outHit = vec4(rayPoint(node, direction, march.t), march.t);
    outNode = nodeIndex + 1u;
    gl_FragDepth = frame.forward.w / max(march.t, frame.forward.w);  // t may be 0, of either sign
}
