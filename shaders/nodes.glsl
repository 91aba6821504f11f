// nodes.glsl: the frame's parameters and the draw nodes, as C++ wrote them.
#ifndef TERRAY_NODES
#define TERRAY_NODES
#include "interop.h"
#if TERRAY_CURVED
#include "math/bend.glsl"
#endif

layout(std430, binding = TERRAY_BUFFER_NODES) readonly buffer NodeBuffer { NodeParameters nodes[]; };
layout(std140, binding = TERRAY_BUFFER_FRAME) uniform FrameBuffer { FrameParameters frame; };

// Where a pixel lies on the picture, -1 .. 1 to the right and up. pixel: centres at + 0.5, as gl_FragCoord.xy, of the part that
// is drawn. Sums of pixels are exact, so that a part's rays are the picture's, to the last bit.
vec2 picturePosition(vec2 pixel) { return 2.0 * (pixel + frame.part.xy) / vec2(frame.right.w, frame.up.w) - 1.0; }

// A pixel of the part that is drawn as one of the picture: for patterns, so that they go on from part to part.
ivec2 picturePixel(ivec2 pixel) { return pixel + ivec2(frame.part.xy); }

// Clip coordinates of a place, reversed depth, infinite far plane: depth = near / view depth. fromEye: metres east, north, up,
// as straight lines of sight see it.
vec4 clipPosition(vec3 fromEye) {
    float depth = dot(fromEye, frame.forward.xyz);
    vec2 onPicture = vec2(dot(fromEye, frame.right.xyz), dot(fromEye, frame.up.xyz)) * frame.viewScale.xy;
    return vec4(onPicture * frame.partClip.xy + depth * frame.partClip.zw, frame.forward.w, depth);
}

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
    return earthDrop(frame.bend.xyz, ground.x, ground.y) / node.right.w;
}

// A corner of a node's box, in metres east, north and up of the eye, as straight lines of sight see it. up: 1 at the box's
// top, 0 at its bottom.
vec3 seenCorner(NodeParameters node, vec3 fromEye, float up) {
    float bulge = up > 0.0 ? node.boxMax.w : -node.boxMin.w;
    return vec3(fromEye.xy, fromEye.z - earthDrop(frame.bend.xyz, fromEye.x, fromEye.y) + bulge);
}

// The slope of a surface, codes per texel, as straight lines of sight see it at a point of the tile frame.
vec2 seenSlope(NodeParameters node, vec2 texel, vec2 slope) {
    vec2 ground = vec2(texel.x - node.eye.x, node.eye.y - texel.y) * node.eye.w;
    vec2 fall = earthFall(frame.bend.xyz, ground.x, ground.y);
    return slope - vec2(fall.x, -fall.y) * (node.eye.w / node.right.w);
}
#else
vec3 seenCorner(NodeParameters node, vec3 fromEye, float up) { return fromEye; }
vec2 seenSlope(NodeParameters node, vec2 texel, vec2 slope) { return slope; }
#endif

// A height of the dataset, metres, not exaggerated. code: as a height of the tile frame.
float heightOfCode(NodeParameters node, float code) {
    return frame.air.y + (code - node.eye.z) * (node.right.w * frame.air.z);
}

// Where a ray is at view depth t: tile frame.
vec3 rayPoint(NodeParameters node, vec3 direction, float t) {
    vec3 point = node.eye.xyz + t * direction;
#if TERRAY_CURVED
    point.z += t * t * rayBend(node, direction);
#endif
    return point;
}

#endif
