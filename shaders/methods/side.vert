// methods/side.vert: the exact bounding box of a draw node, of which the side walls are drawn: where rays enter it other than from
// above.
#include "methods/geometry.glsl"

void main() {
    NodeParameters node = nodes[nodeIndex];
    vec3 corner = vec3(gl_VertexID & 1, (gl_VertexID >> 1) & 1, gl_VertexID >> 2);
    vec3 fromEye = metresFromEye(node, mix(node.boxMin.xyz, node.boxMax.xyz, corner));
    gl_Position = clipPosition(seenCorner(node, fromEye, corner.z));
}
