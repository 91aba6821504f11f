// methods/hull.frag: searches the ground from where a ray comes below the pushed-up mesh through one of its front faces.
#include "methods/hull_output.glsl"

void main() {
    NodeParameters node = nodes[nodeIndex];
    castFrom(node, rayDirection(node, picturePosition(gl_FragCoord.xy)), 1.0 / gl_FragCoord.w);
}
