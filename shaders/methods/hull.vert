// methods/hull.vert: a vertex of the pushed-up mesh over a node's cell. A strip for each row of quads (an instance).
#include "methods/geometry.glsl"
#include "methods/hull_height.glsl"

layout(location = TERRAY_UNIFORM_GEOMETRY) uniform ivec3 quads;  // first column and row; quads along the tile's side

out float gl_ClipDistance[4];

void main() {
    NodeParameters node = nodes[nodeIndex];
    ivec2 vertex = quads.xy + ivec2(gl_VertexID >> 1, gl_InstanceID + (gl_VertexID & 1));
    float quad = 512.0 / float(quads.z);  // texels
    vec2 texel = vec2(vertex) * quad;
    vec3 fromEye = seenPoint(metresFromEye(node, vec3(texel, hullHeight(vertex, node.source.x))));
#if TERRAY_CURVED
    // The earth bulges between vertices: the box's own bulge, which grows with the square of the side.
    float part = quad / (node.boxMax.x - node.boxMin.x);
    fromEye.z += node.boxMax.w * part * part;
#endif
    gl_Position = clipPosition(fromEye);
    gl_ClipDistance[0] = texel.x - node.boxMin.x;
    gl_ClipDistance[1] = node.boxMax.x - texel.x;
    gl_ClipDistance[2] = texel.y - node.boxMin.y;
    gl_ClipDistance[3] = node.boxMax.y - texel.y;
}
