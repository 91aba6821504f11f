// methods/mesh_side.frag: the sides of a node's box below its ground: walls at level jumps and at the dataset's edge. They reach up
// to where triangles may lie, so that nothing shows through between two tiles.
#include "methods/ground.glsl"
#include "methods/mesh_output.glsl"

layout(location = TERRAY_UNIFORM_SLACK) uniform float slack;  // codes

void main() {
    NodeParameters node = nodes[nodeIndex];
    vec4 hit = fragmentHit(node);
    if (hit.z > groundCode(node, hit.xy) + slack) discard;
    put(hit);
}
