// methods/linear.glsl: uniform steps through the node's box, then halving (paper 003: Kentie, "On-GPU ray traced terrain",
// sections 3.3 and 3.4; appendix A). The number of samples depends on the view: few for rays that look down, many for flat
// ones, by 1 - |vertical part of the direction|.
// Unlike the paper, whose one box holds all ground, each node is a box of its own with that many samples; the last of them is
// the box's exit, so that a ray that leaves through solid ground is seen to; and no step's length is added to the ground.
// Fails by design: whatever is thinner along the ray than a step is missed: summits, walls, ridges before the sky.
#ifndef TERRAY_METHOD_LINEAR_MODULE
#define TERRAY_METHOD_LINEAR_MODULE
#include "march_result.glsl"
#include "methods/ground.glsl"

March marchNode(NodeParameters node, vec3 direction) {
    March march = March(false, false, 0, 0.0);
    Interval part = partInBox(node, direction);
    if (!(part.enter <= part.exit)) return march;
    int samples = int(mix(method.linear.x, method.linear.y, 1.0 - abs(riseOf(node, direction))));
    float stride = (part.exit - part.enter) / float(samples);
    float before = part.enter;
    for (int i = 0; i <= samples; ++i) {
        float t = i < samples ? part.enter + float(i) * stride : part.exit;
        ++march.steps;
        if (clearanceOf(node, direction, t) <= 0.0) {
            march.hit = true;
            march.t = i == 0 ? t : halved(node, direction, before, t, int(method.linear.z), march.steps);
            return march;
        }
        before = t;
    }
    return march;
}

#endif
