// march.glsl: first hit of a ray with the surface of a node, along the maximum mipmap of its height tile.
// Frame: tile. Source: Dick, Krueger, Westermann 2009, sections 3.1 and 3.2; patches: patches.glsl.
// Watertight: the ground is solid, so a ray that enters below the surface hits where it enters; cells are integers; t never
// decreases; each pass of the loop either raises a cell coordinate or goes one level down. There are at most 1024 of the
// former; each climbs at most one level, so with the 8 levels of the start there are at most 1032 of the latter. A ray meets
// at most 512 blocks of 2 x 2 cells, and in each at most 5 patches and the step behind it.
// A ray that reaches kMaxSteps is reported as a defect.
#ifndef TERRAY_MARCH
#define TERRAY_MARCH
#include "heights.glsl"
#include "math/box.glsl"
#include "math/cell_walk.glsl"
#include "nodes.glsl"
#include "ray.glsl"
#if TERRAY_BILINEAR
#include "patches.glsl"
#endif

#if TERRAY_BILINEAR
const int kMaxSteps = 1024 + 1032 + 512 * 6 + 1;
#else
const int kMaxSteps = 1024 + 1032 + 1;
#endif

#include "march_result.glsl"

March marchNode(NodeParameters node, vec3 direction) {
    March march = March(false, false, 0, 0.0);
    Ray ray = mirroredRay(node, direction);
    vec2 side = vec2(float(kCore));
    vec3 boxMin = vec3(mix(node.boxMin.xy, side - node.boxMax.xy, ray.mirrored), node.boxMin.z);
    vec3 boxMax = vec3(mix(node.boxMax.xy, side - node.boxMin.xy, ray.mirrored), node.boxMax.z);
    Interval box = clippedRay(ray, boxMin, boxMax);
    if (!(box.enter <= box.exit)) return march;

    // The cells of the node's sub-rectangle; deeper than a texel it is a part of one cell.
    ivec2 last = ivec2(ceil(boxMax.xy)) - 1;
    ivec2 cell = clamp(ivec2(floor(ray.eye.xy + box.enter * ray.direction.xy)), ivec2(floor(boxMin.xy)), last);
    int coarsest = int(node.source.w & TERRAY_START_LEVEL_MASK);
#if TERRAY_BILINEAR
    // Patches lie across the cells' borders, so they are tried for a block of 2 x 2 cells at a time.
    bool bilinear = (node.source.w & TERRAY_BILINEAR_BIT) != 0u;
    int leaf = bilinear ? 1 : 0;
#else
    const int leaf = 0;
#endif
    int level = coarsest;
    float t = box.enter;

    // Blocks until one at the leaf level is met, then its surface: two phases, so that rays of a group that still walk do not
    // pay for the tests of those that have arrived (Aila and Laine 2009, "Understanding the Efficiency of Ray Traversal on
    // GPUs").
    for (;;) {
        ivec2 edge = ivec2(0);
        vec2 times = vec2(0.0);
        float leave = t;
        float contact = kNoContact;
        for (; march.steps < kMaxSteps; ++march.steps) {
            ivec2 block = cell >> level;
            ivec2 stored = mix(block, (kCore >> level) - 1 - block, ray.mirrored);
            uint top = blockMaximum(stored, node.source.x, level);
            edge = blockEdge(cell, level);
            times = edgeTimes(edge, ray.eye.xy, ray.inverse.xy);
            leave = max(t, min(min(times.x, times.y), box.exit));
            contact = top == 0u ? kNoContact : blockContact(ray, float(top), t, leave);
            if (contact != kNoContact) {
                if (level == leaf) break;
                t = contact;
                cell = cellAt(t, cell, edge, ray.eye.xy, ray.direction.xy);
                --level;
            } else {
                if (leave >= box.exit) return march;
                cell = cellAfter(cell, edge, times, ray.eye.xy, ray.direction.xy);
                if (any(greaterThan(cell, last))) return march;
                level = max(levelAfter(level, coarsest, edge, times), leaf);
                t = leave;
            }
        }
        if (contact == kNoContact) {
            march.exhausted = true;
            return march;
        }
#if TERRAY_BILINEAR
        if (bilinear) contact = patchContact(ray, node.source.x, edge, t, leave, march.steps);
        if (contact == kNoContact) {
            ++march.steps;
            if (leave >= box.exit) return march;
            cell = cellAfter(cell, edge, times, ray.eye.xy, ray.direction.xy);
            if (any(greaterThan(cell, last))) return march;
            level = levelAfter(level, coarsest, edge, times);
            t = leave;
            continue;
        }
#endif
        march.hit = true;
        march.t = contact;
        return march;
    }
}

#endif
