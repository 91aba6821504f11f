// march.comp: casts all rays in one dispatch. A work group bins the nodes' boxes to its square of pixels, then each of its
// threads marches one ray through the binned nodes, which come front to back, until the first hit (design, section 5).
// The bin is a bit for each node, so binning in any order keeps the nodes' order.
#include "march.glsl"

layout(local_size_x = TERRAY_GROUP_SIDE, local_size_y = TERRAY_GROUP_SIDE) in;

// Of each node: least x, least y, greatest x, greatest y of the pixels that its box covers, counted like gl_FragCoord.
layout(std430, binding = TERRAY_BUFFER_BOXES) readonly buffer BoxBuffer { vec4 boxes[]; };
layout(location = TERRAY_UNIFORM_NODE) uniform uint nodeCount;
layout(binding = TERRAY_IMAGE_HIT, rgba32f) writeonly uniform image2D hitImage;
layout(binding = TERRAY_IMAGE_NODE, r32ui) writeonly uniform uimage2D nodeImage;
#if TERRAY_STATISTICS
layout(binding = TERRAY_IMAGE_STEPS, r32ui) writeonly uniform uimage2D stepImage;
#endif

const uint kBinWords = TERRAY_BIN_NODES / 32;
const uint kThreads = TERRAY_GROUP_SIDE * TERRAY_GROUP_SIDE;
shared uint bin[kBinWords];

// Marks the nodes from `first` on whose boxes touch this group's pixels.
void binNodes(uint first) {
    for (uint word = gl_LocalInvocationIndex; word < kBinWords; word += kThreads) bin[word] = 0u;
    barrier();
    vec2 least = vec2(gl_WorkGroupID.xy) * TERRAY_GROUP_SIDE;
    vec2 greatest = least + TERRAY_GROUP_SIDE;
    uint count = min(nodeCount - first, uint(TERRAY_BIN_NODES));
    for (uint i = gl_LocalInvocationIndex; i < count; i += kThreads) {
        vec4 box = boxes[first + i];
        bool touches = all(lessThanEqual(box.xy, greatest)) && all(greaterThanEqual(box.zw, least));
        if (touches) atomicOr(bin[i >> 5], 1u << (i & 31u));
    }
    barrier();
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    vec2 position = picturePosition(vec2(pixel) + 0.5);
    bool inPicture = all(lessThan(vec2(pixel), vec2(frame.right.w, frame.up.w)));

    vec4 hit = vec4(0.0);
    uint found = 0u;
    uint steps = 0u;
    for (uint first = 0u; first < nodeCount; first += TERRAY_BIN_NODES) {
        binNodes(first);
        uint words = (min(nodeCount - first, uint(TERRAY_BIN_NODES)) + 31u) / 32u;
        for (uint word = 0u; word < words && found == 0u && inPicture; ++word) {
            for (uint rest = bin[word]; rest != 0u && found == 0u; rest &= rest - 1u) {
                uint index = first + 32u * word + uint(findLSB(rest));
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
        }
        barrier();
    }
    if (!inPicture) return;
    imageStore(hitImage, pixel, hit);
    imageStore(nodeImage, pixel, uvec4(found));
#if TERRAY_STATISTICS
    imageStore(stepImage, pixel, uvec4(steps));
#endif
}
