// math/air.glsl: how much air lies along a straight path over flat ground, whose density falls exponentially with height.
// Metres. A column is given as the length of a path at sea level that has as much air.
#ifndef TERRAY_MATH_AIR
#define TERRAY_MATH_AIR
#include "math/portable.glsl"

// Mean of exp(-s x) over s = 0 .. 1, that is (1 - exp(-x)) / x, for x >= 0. Below 1/8, where the difference would cancel,
// the series: its first missing term is below 5e-8 there, and above it the difference loses no more than 3 bits.
MATH_FUNCTION real meanDecay(real x) {
    if (x < REAL(0.125)) {
        return REAL(1.0) -
               x / REAL(2.0) *
                   (REAL(1.0) - x / REAL(3.0) * (REAL(1.0) - x / REAL(4.0) * (REAL(1.0) - x / REAL(5.0))));
    }
    return (REAL(1.0) - exp(-x)) / x;
}

// Along a path of so many metres between two heights. The air's density falls by 1/e over scaleHeight.
MATH_FUNCTION real airColumn(real fromHeight, real toHeight, real pathLength, real scaleHeight) {
    real lower = min(fromHeight, toHeight);
    return pathLength * exp(-lower / scaleHeight) * meanDecay(abs(toHeight - fromHeight) / scaleHeight);
}

// Along an endless path from a height. rise: sine of its elevation; a path that does not rise has no end to its air, and
// counts as one that rises by 1e-6.
MATH_FUNCTION real airColumnToSpace(real fromHeight, real rise, real scaleHeight) {
    return scaleHeight * exp(-fromHeight / scaleHeight) / max(rise, REAL(1e-6));
}

#endif
