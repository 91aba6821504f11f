// nodes.glsl: the frame's parameters and the draw nodes, as C++ wrote them.
#ifndef TERRAY_NODES
#define TERRAY_NODES
#include "interop.h"

layout(std430, binding = TERRAY_BUFFER_NODES) readonly buffer NodeBuffer { NodeParameters nodes[]; };
layout(std140, binding = TERRAY_BUFFER_FRAME) uniform FrameBuffer { FrameParameters frame; };

// Where a pixel lies on the picture, -1 .. 1 to the right and up. pixel: centres at + 0.5, as gl_FragCoord.xy.
vec2 picturePosition(vec2 pixel) { return 2.0 * pixel / vec2(frame.right.w, frame.up.w) - 1.0; }

// Direction of a pixel's ray in the node's tile frame, for one metre of view depth. From the camera, not from the box's
// vertices, so that neighbouring nodes see the same ray.
vec3 rayDirection(NodeParameters node, vec2 position) {
    return node.forward.xyz + position.x * node.right.xyz + position.y * node.up.xyz;
}

#if TERRAY_CURVED
// Codes that a ray gains over the flat map per squared metre of view depth, because the earth falls away beneath it
// (design, section 5). direction: of the ray, tile frame.
float rayBend(NodeParameters node, vec3 direction) {
    vec2 ground = vec2(direction.x, -direction.y) * node.eye.w;  // metres east and north
    return (frame.bend.x * ground.x * ground.x + frame.bend.y * ground.x * ground.y +
            frame.bend.z * ground.y * ground.y) / node.right.w;
}
#endif

// Where a ray is at view depth t: tile frame.
vec3 rayPoint(NodeParameters node, vec3 direction, float t) {
    vec3 point = node.eye.xyz + t * direction;
#if TERRAY_CURVED
    point.z += t * t * rayBend(node, direction);
#endif
    return point;
}

#endif
