// math/cell_walk.glsl: from cell to cell of a maximum mipmap along a ray.
// Frame: tile, mirrored so that the ray never runs towards smaller x or y (paper 001, section 3.1). Cells are integers at
// level 0; a block of level l is 2^l x 2^l cells. t: view depth in metres.
// Source: Dick, Krueger, Westermann 2009, "GPU Ray-Casting for Scalable Terrain Rendering", sections 3.1 and 3.2.
#ifndef TERRAY_MATH_CELL_WALK
#define TERRAY_MATH_CELL_WALK
#include "math/portable.glsl"

// The cells' far corner of the block that holds `cell`: the edges through which a ray leaves it.
MATH_FUNCTION ivec2 blockEdge(ivec2 cell, int level) {
    return ivec2(((cell.x >> level) + 1) << level, ((cell.y >> level) + 1) << level);
}

// t at which the ray crosses x = edge.x and y = edge.y. inverse is safeInverse of a mirrored direction, so positive.
MATH_FUNCTION vec2 edgeTimes(ivec2 edge, vec2 eye, vec2 inverse) {
    return vec2((real(edge.x) - eye.x) * inverse.x, (real(edge.y) - eye.y) * inverse.y);
}

// The cell that a ray enters when it leaves a block through the earlier of its two edges. The crossed coordinate is set to
// the integer edge, so rounding cannot hold the ray back; the other one is rounded into the block and never falls behind
// `cell`. Each call raises cell.x or cell.y, which bounds the number of steps.
MATH_FUNCTION ivec2 cellAfter(ivec2 cell, ivec2 edge, vec2 times, vec2 eye, vec2 direction) {
    if (times.x <= times.y) {
        int y = int(floor(eye.y + times.x * direction.y));
        return ivec2(edge.x, min(max(y, cell.y), edge.y - 1));
    }
    int x = int(floor(eye.x + times.y * direction.x));
    return ivec2(min(max(x, cell.x), edge.x - 1), edge.y);
}

// The level to continue with after leaving a block of `level`: one coarser when a 2 x 2 group of blocks is left
// (paper 001: min(level + 1 - (Edge mod 2), coarsest)).
MATH_FUNCTION int levelAfter(int level, int coarsest, ivec2 edge, vec2 times) {
    int crossed = (times.x <= times.y ? edge.x : edge.y) >> level;
    return min(level + 1 - (crossed & 1), coarsest);
}

// The cell at time t inside a block, not behind `cell`: where to go on one level finer.
MATH_FUNCTION ivec2 cellAt(real t, ivec2 cell, ivec2 edge, vec2 eye, vec2 direction) {
    int x = int(floor(eye.x + t * direction.x));
    int y = int(floor(eye.y + t * direction.y));
    return ivec2(min(max(x, cell.x), edge.x - 1), min(max(y, cell.y), edge.y - 1));
}

#endif
