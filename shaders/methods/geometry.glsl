// methods/geometry.glsl: a point of a method's geometry on the screen, for vertex stages. Reversed depth, infinite far plane, as
// in box.vert; the perspective divide's w is the view depth in metres.
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

// fromEye: metres east, north, up.
vec4 projectedPoint(vec3 fromEye) {
    return vec4(dot(fromEye, frame.right.xyz) * frame.viewScale.x, dot(fromEye, frame.up.xyz) * frame.viewScale.y,
                frame.forward.w, dot(fromEye, frame.forward.xyz));
}

// Tile frame to metres from the eye.
vec3 metresFromEye(NodeParameters node, vec3 point) {
    return (point - node.eye.xyz) * vec3(node.eye.w, -node.eye.w, node.right.w);
}

#endif
