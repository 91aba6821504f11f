#pragma once
// shaders/math for eight rays at once: the same functions and formulas, with selections in the place of branches.
// Frame: map (height_pyramid.h), mirrored for each ray so that it never runs towards smaller x or y. t: view depth,
// metres. Sources: as named in shaders/math/{box,cell_walk,column,patch,contact}.glsl.

#include "tests/bench/packet_march/lanes.h"

namespace terray::TERRAY_LANES {

/// x and y of eight points or directions.
struct Pair {
    Float x;
    Float y;
};
struct IntPair {
    Int x;
    Int y;
};

// --- box.glsl
// ---------------------------------------------------------------------------------------------------------

inline Float safeInverse(Float component) {
    const Float size = maximum(magnitude(component), all(1e-30F));
    return negatedWhere(component < 0, 1.0F / size);
}

// --- cell_walk.glsl
// ---------------------------------------------------------------------------------------------------

inline IntPair blockEdge(IntPair cell, Int level) {
    return {((cell.x >> level) + 1) << level, ((cell.y >> level) + 1) << level};
}

inline Pair edgeTimes(IntPair edge, Pair eye, Pair inverse) {
    return {(converted(edge.x) - eye.x) * inverse.x, (converted(edge.y) - eye.y) * inverse.y};
}

/// Through which of its far edges a ray leaves a block; at equal times through the one in x.
struct Crossing {
    Int x;  ///< masks; neither is set where the ray stays in the block
    Int y;
};

/// cellAfter() where an edge is crossed, else cellAt(): the crossed coordinate is the integer edge, any other one is
/// rounded into the block and never falls behind `cell`. at: the ray's position, whole part (truncated or floored).
inline IntPair cellFrom(IntPair at, IntPair cell, IntPair edge, Crossing crossing) {
    // edge - 1, or edge where it is crossed: a mask is -1.
    return {clamp(at.x, select(crossing.x, edge.x, cell.x), edge.x + ~crossing.x),
            clamp(at.y, select(crossing.y, edge.y, cell.y), edge.y + ~crossing.y)};
}

inline Int levelAfter(Int level, Int coarsest, IntPair edge, Crossing crossing) {
    const Int crossed = select(crossing.x, edge.x, edge.y) >> level;
    return minimum(level + 1 - (crossed & 1), coarsest);
}

// --- patch.glsl, contact.glsl
// -----------------------------------------------------------------------------------------

struct Corners {
    Float h00;
    Float h10;
    Float h01;
    Float h11;
};

struct Clearance {
    Float bend;
    Float slope;
    Float start;
};

/// at: u, v and height of the ray where it enters the patch. direction: their change per unit of s.
inline Clearance patchClearance(const Corners& corners, Pair at, Float height, Pair direction, Float rise) {
    const Float east = corners.h10 - corners.h00;
    const Float south = corners.h01 - corners.h00;
    const Float twist = (corners.h11 - corners.h01) - east;
    const Float alongU = mulAdd(at.y, twist, east);
    const Float alongV = mulAdd(at.x, twist, south);
    const Float ground = mulAdd(at.x, alongU, mulAdd(at.y, south, corners.h00));
    return {-twist * direction.x * direction.y, rise - alongU * direction.x - alongV * direction.y, height - ground};
}

inline Float clearanceAt(const Clearance& clearance, Float s) {
    return mulAdd(mulAdd(clearance.bend, s, clearance.slope), s, clearance.start);
}

struct Contact {
    Int touches;  ///< mask
    Float s;      ///< where it touches
};

inline Contact firstContact(const Clearance& clearance, Float span) {
    const Int inside = clearance.start <= 0;
    const Int below = clearanceAt(clearance, span) <= 0;
    const Int falls = clearance.slope < 0;
    const Int dips = falls & (-clearance.slope < 2.0F * clearance.bend * span);
    const Float discriminant = clearance.slope * clearance.slope - 4.0F * clearance.bend * clearance.start;
    const Float root = squareRoot(maximum(discriminant, Float{}));
    const Float above = select(falls, 2.0F * clearance.start, root + clearance.slope);
    const Float under = select(falls, root - clearance.slope, maximum(-2.0F * clearance.bend, all(1e-37F)));
    const Float s = clamp(above / under, Float{}, span);
    return {inside | below | (dips & (discriminant >= 0)), select(inside, Float{}, s)};
}

}  // namespace terray::TERRAY_LANES
