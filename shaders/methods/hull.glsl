// methods/hull.glsl: from the pushed-up mesh to the ground (paper 002, section 4): steps that are equally long (4.4) or that double
// (4.3); for rays that have not met the ground then, more and longer ones; at last the secant method.
// Lengths are the paper's: in a frame where the tile is 1 wide and the box 1 high; a stride is given in quads of the mesh.
// Fails by design: a ray that needs more steps than it is given finds nothing and what lies behind shows; what is thinner than
// a stride is stepped over (the paper: flat rays, edges of hills).
#ifndef TERRAY_METHOD_HULL_MODULE
#define TERRAY_METHOD_HULL_MODULE
#include "march_result.glsl"
#include "methods/ground.glsl"

// The end of the ray's i-th step (from 0), as a share of its way to the box's exit.
// 4.3, equation 3 and table 1: each step ends twice as far along the way as the one before, the last at its end.
float exponentialShare(int i, int steps) { return exp2(float(i + 1 - steps)); }

// From where the ray has come below the mesh.
March searchBelow(NodeParameters node, vec3 direction, float start) {
    March march = March(false, false, 1, start);
    float exit = max(partInBox(node, direction).exit, start);
    float before = start;
    float above = clearanceOf(node, direction, start);
    if (above <= 0.0) {
        march.hit = true;
        return march;
    }
    int first = int(method.hull.x), second = int(method.hull.y);
    bool exponential = method.hull.z < 0.0;
    vec3 unit = direction / vec3(vec2(512.0), max(node.boxMax.z - node.boxMin.z, 1.0));
    float stride = method.hull.z / length(unit);
    float t = start;
    for (int i = 0; i < first + (exponential ? 0 : second) && t < exit; ++i, ++march.steps) {
        t = exponential ? mix(start, exit, exponentialShare(i, first)) : t + (i < first ? stride : method.hullMore.x * stride);
        t = min(t, exit);
        float here = clearanceOf(node, direction, t);
        if (here > 0.0) {
            before = t;
            above = here;
            continue;
        }
        // The secant between the last point above and the first one below.
        for (int k = 0; k < int(method.hull.w); ++k, ++march.steps) {
            float between = mix(before, t, above / (above - here));
            float middle = clearanceOf(node, direction, between);
            if (middle > 0.0) {
                before = between;
                above = middle;
            } else {
                t = between;
                here = middle;
            }
        }
        march.hit = true;
        march.t = mix(before, t, above / (above - here));
        return march;
    }
    return march;
}

#endif
