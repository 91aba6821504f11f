// methods/geometry.glsl: a point of a method's geometry as clipPosition() takes it, for vertex stages; the perspective divide's
// w is the view depth in metres.
#ifndef TERRAY_METHOD_GEOMETRY
#define TERRAY_METHOD_GEOMETRY
#include "nodes.glsl"

layout(location = TERRAY_UNIFORM_NODE) uniform uint nodeIndex;

// Over a curved earth, where straight lines of sight see the point.
vec3 seenPoint(vec3 fromEye) {
#if TERRAY_CURVED
    fromEye.z -= earthDrop(frame.bend.xyz, fromEye.x, fromEye.y);
#endif
    return fromEye;
}

// Tile frame to metres from the eye.
vec3 metresFromEye(NodeParameters node, vec3 point) {
    return (point - node.eye.xyz) * vec3(node.eye.w, -node.eye.w, node.right.w);
}

#endif
