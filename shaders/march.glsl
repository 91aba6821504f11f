// march.glsl: first hit of a ray with the columns of a node, along the maximum mipmap of its height tile.
// Frame: tile. Source: Dick, Krueger, Westermann 2009, sections 3.1 and 3.2.
// Watertight: the ground is solid, so a ray that enters below the surface hits where it enters; cells are integers; t never
// decreases; each pass of the loop either raises a cell coordinate or goes one level down. There are at most 1024 of the
// former; each climbs at most one level, so with the 8 levels of the start there are at most 1032 of the latter.
// A ray that reaches kMaxSteps is reported as a defect.
#ifndef TERRAY_MARCH
#define TERRAY_MARCH
#include "heights.glsl"
#include "math/box.glsl"
#include "math/cell_walk.glsl"
#include "math/column.glsl"
#include "nodes.glsl"

const int kMaxSteps = 1024 + 1032 + 1;

struct March {
    bool hit;
    bool exhausted;  // out of steps
    int steps;
    float t;         // view depth of the hit, metres
};

March marchNode(NodeParameters node, vec3 direction) {
    March march = March(false, false, 0, 0.0);

    // Mirror x and y so that the ray runs towards larger ones.
    bvec2 mirrored = lessThan(direction.xy, vec2(0.0));
    vec2 side = vec2(float(kCore));
    vec3 dir = vec3(abs(direction.xy), direction.z);
    vec3 eye = vec3(mix(node.eye.xy, side - node.eye.xy, mirrored), node.eye.z);
    vec3 boxMin = vec3(mix(node.boxMin.xy, side - node.boxMax.xy, mirrored), node.boxMin.z);
    vec3 boxMax = vec3(mix(node.boxMax.xy, side - node.boxMin.xy, mirrored), node.boxMax.z);
    vec3 inverse = vec3(safeInverse(dir.x), safeInverse(dir.y), safeInverse(dir.z));

    Interval box = boxInterval(eye, inverse, boxMin, boxMax);
    if (!(box.enter <= box.exit)) return march;

    // The cells of the node's sub-rectangle; deeper than a texel it is a part of one cell.
    ivec2 last = ivec2(ceil(boxMax.xy)) - 1;
    ivec2 cell = clamp(ivec2(floor(eye.xy + box.enter * dir.xy)), ivec2(floor(boxMin.xy)), last);
    int coarsest = int(node.source.w);
    int level = coarsest;
    float t = box.enter;

    for (; march.steps < kMaxSteps; ++march.steps) {
        ivec2 block = cell >> level;
        ivec2 stored = mix(block, (kCore >> level) - 1 - block, mirrored);
        float top = float(blockMaximum(stored, node.source.x, level));
        ivec2 edge = blockEdge(cell, level);
        vec2 times = edgeTimes(edge, eye.xy, inverse.xy);
        float leave = max(t, min(min(times.x, times.y), box.exit));

        if (top > 0.0 && meetsColumn(top, eye.z, dir.z, t, leave)) {
            t = columnTime(top, eye.z, dir.z, inverse.z, t, leave);
            if (level == 0) {
                march.hit = true;
                march.t = t;
                return march;
            }
            cell = cellAt(t, cell, edge, eye.xy, dir.xy);
            --level;
        } else {
            if (leave >= box.exit) return march;
            cell = cellAfter(cell, edge, times, eye.xy, dir.xy);
            if (any(greaterThan(cell, last))) return march;
            level = levelAfter(level, coarsest, edge, times);
            t = leave;
        }
    }
    march.exhausted = true;
    return march;
}

#endif
