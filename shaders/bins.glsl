// bins.glsl: which nodes a square of pixels must try, for the compute launch. A bin is a bit for each node, so that filling it
// in any order keeps the nodes' order, front to back.
#ifndef TERRAY_BINS
#define TERRAY_BINS
#include "nodes.glsl"

// Of each node: least x, least y, greatest x, greatest y of the pixels that its box covers, counted like gl_FragCoord.
layout(std430, binding = TERRAY_BUFFER_BOXES) readonly buffer BoxBuffer { vec4 boxes[]; };
layout(location = TERRAY_UNIFORM_NODE) uniform uint nodeCount;

uint wordsOfBin() { return (nodeCount + 31u) / 32u; }

// Where the words of a bin begin. bin: column and row, counted from the lower left corner of what is drawn.
uint firstWord(uvec2 bin) {
    uint binsAcross = (uint(frame.part.z) + TERRAY_BIN_SIDE - 1u) / TERRAY_BIN_SIDE;
    return (bin.y * binsAcross + bin.x) * wordsOfBin();
}

bool touches(vec4 box, vec2 least, vec2 greatest) {
    return all(lessThanEqual(box.xy, greatest)) && all(greaterThanEqual(box.zw, least));
}

#endif
