// methods/hull_side.frag: searches the ground for rays that enter a node's box through a side, or begin within it, below the
// pushed-up mesh; those above it meet the mesh later.
#include "methods/hull_height.glsl"
#include "methods/hull_output.glsl"

layout(location = TERRAY_UNIFORM_INSIDE) uniform bool inside;  // the eye is over the node: back faces are drawn

void main() {
    NodeParameters node = nodes[nodeIndex];
    vec3 direction = rayDirection(node, picturePosition(gl_FragCoord.xy));
    float start = inside ? 0.0 : 1.0 / gl_FragCoord.w;
    vec3 entry = rayPoint(node, direction, start);
    if (entry.z > hullAt(entry.xy, node.source.x)) discard;
    castFrom(node, direction, start);
}
