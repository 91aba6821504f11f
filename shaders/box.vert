// box.vert: the bounding box of a draw node, widened by a pixel so that every pixel whose ray meets the box is covered.
// The march itself uses the exact box.
#include "nodes.glsl"

layout(location = TERRAY_UNIFORM_NODE) uniform uint nodeIndex;

void main() {
    NodeParameters node = nodes[nodeIndex];
    vec3 scale = vec3(node.eye.w, -node.eye.w, node.right.w);  // tile frame to metres east, north, up
    vec3 corner = vec3(gl_VertexID & 1, (gl_VertexID >> 1) & 1, gl_VertexID >> 2);
    vec3 fromEye = (mix(node.boxMin.xyz, node.boxMax.xyz, corner) - node.eye.xyz) * scale;
    fromEye = seenCorner(node, fromEye, corner.z);
    fromEye += (2.0 * corner - 1.0) * sign(scale) * node.up.w;
    gl_Position = clipPosition(fromEye);
}
