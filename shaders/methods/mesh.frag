// methods/mesh.frag: a triangle of a tile's triangulation. Where its tile has holes, cells without surface are left out.
#include "heights.glsl"
#include "methods/mesh_output.glsl"

layout(location = TERRAY_UNIFORM_HOLED) uniform bool holed;

void main() {
    NodeParameters node = nodes[nodeIndex];
    vec4 hit = fragmentHit(node);
    if (holed && blockMaximum(clamp(ivec2(floor(hit.xy)), ivec2(0), ivec2(kCore - 1)), node.source.x, 0) == 0u) discard;
    put(hit);
}
