// march.comp: casts all rays in one dispatch. Each thread marches one ray through the nodes of its bin, which come front to
// back, until the first hit (design, section 5).
#include "bins.glsl"
#include "method.glsl"

layout(local_size_x = TERRAY_GROUP_SIDE, local_size_y = TERRAY_GROUP_SIDE) in;

layout(std430, binding = TERRAY_BUFFER_BINS) readonly buffer BinBuffer { uint bins[]; };
layout(binding = TERRAY_IMAGE_HIT, rgba32f) writeonly uniform image2D hitImage;
layout(binding = TERRAY_IMAGE_NODE, r32ui) writeonly uniform uimage2D nodeImage;
#if TERRAY_STATISTICS
layout(binding = TERRAY_IMAGE_STEPS, r32ui) writeonly uniform uimage2D stepImage;
#endif

const uint kNoNode = 0xffffffffu;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(vec2(pixel), frame.part.zw))) return;
    vec2 centre = vec2(pixel) + 0.5;
    vec2 position = picturePosition(centre);

    vec4 hit = vec4(0.0);
    uint found = 0u;
    uint steps = 0u;
    uint words = wordsOfBin();
    uint base = firstWord(gl_WorkGroupID.xy * TERRAY_GROUP_SIDE / TERRAY_BIN_SIDE);
    uint word = 0u;
    uint rest = bins[base];
    // Two phases again: first the next node whose box covers this pixel, then its march.
    while (found == 0u) {
        uint index = kNoNode;
        while (index == kNoNode && word < words) {
            if (rest == 0u) {
                ++word;
                rest = word < words ? bins[base + word] : 0u;
            } else {
                uint candidate = 32u * word + uint(findLSB(rest));
                rest &= rest - 1u;
                if (touches(boxes[candidate], centre, centre)) index = candidate;
            }
        }
        if (index == kNoNode) break;
        NodeParameters node = nodes[index];
        vec3 direction = rayDirection(node, position);
        March march = marchNode(node, direction);
        steps += uint(march.steps);
        if (march.exhausted) steps |= 0x80000000u;
        if (march.hit) {
            hit = vec4(rayPoint(node, direction, march.t), march.t);
            found = index + 1u;
        }
    }
    imageStore(hitImage, pixel, hit);
    imageStore(nodeImage, pixel, uvec4(found));
#if TERRAY_STATISTICS
    imageStore(stepImage, pixel, uvec4(steps));
#endif
}
