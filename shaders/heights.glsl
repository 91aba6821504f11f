// heights.glsl: the height array. Level 0: 516 x 516 codes with an apron of 2; level l > 0: maxima of 2^l x 2^l core cells and
// the ring of cells around them.
#ifndef TERRAY_HEIGHTS
#define TERRAY_HEIGHTS
#include "interop.h"

layout(binding = TERRAY_UNIT_HEIGHTS) uniform usampler2DArray heightCodes;

const int kCore = 512;
const int kApron = 2;

// Greatest code in and around a block of core cells, 0 where they have no surface; level 0: the cell's own code.
uint blockMaximum(ivec2 block, uint slot, int level) {
    int shift = level == 0 ? kApron : 0;
    return texelFetch(heightCodes, ivec3(block + shift, slot), level).r;
}

#endif
