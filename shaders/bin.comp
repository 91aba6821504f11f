// bin.comp: sorts the nodes' boxes into squares of pixels (design, section 5). A work group for each bin, a thread for each
// word of 32 nodes: no shared memory, no atomics, no barrier.
#include "bins.glsl"

layout(local_size_x = 32) in;

layout(std430, binding = TERRAY_BUFFER_BINS) writeonly buffer BinBuffer { uint bins[]; };

void main() {
    vec2 least = vec2(gl_WorkGroupID.xy) * TERRAY_BIN_SIDE;
    vec2 greatest = least + TERRAY_BIN_SIDE;
    for (uint word = gl_LocalInvocationIndex; word < wordsOfBin(); word += gl_WorkGroupSize.x) {
        uint first = 32u * word;
        uint bits = 0u;
        for (uint i = 0u; i < min(nodeCount - first, 32u); ++i)
            if (touches(boxes[first + i], least, greatest)) bits |= 1u << i;
        bins[firstWord(gl_WorkGroupID.xy) + word] = bits;
    }
}
