// nodes.glsl: the frame's parameters and the draw nodes, as C++ wrote them.
#ifndef TERRAY_NODES
#define TERRAY_NODES
#include "interop.h"

layout(std430, binding = TERRAY_BUFFER_NODES) readonly buffer NodeBuffer { NodeParameters nodes[]; };
layout(std140, binding = TERRAY_BUFFER_FRAME) uniform FrameBuffer { FrameParameters frame; };

// Where a pixel lies on the picture, -1 .. 1 to the right and up. pixel: gl_FragCoord.xy.
vec2 picturePosition(vec2 pixel) { return 2.0 * pixel / vec2(frame.right.w, frame.up.w) - 1.0; }

// Direction of a pixel's ray in the node's tile frame, for one metre of view depth. From the camera, not from the box's
// vertices, so that neighbouring nodes see the same ray.
vec3 rayDirection(NodeParameters node, vec2 position) {
    return node.forward.xyz + position.x * node.right.xyz + position.y * node.up.xyz;
}

#endif
