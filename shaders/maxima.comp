// Maximum mipmap of one height tile (paper 001, section 3.2): up to five levels from the one below, in one dispatch.
// A thread reduces 4 x 4 source texels by itself (levels 1 and 2 above the source), its 8 x 8 group the rest through
// shared memory (levels 3, 4, 5). From the codes' 512 x 512 core, 16 x 16 groups build levels 1..5; one more group
// builds 6..9 from level 5.
// A block's maximum includes the ring of samples around it: the bilinear surface over a block interpolates between them
// (paper 000, section 3.7), so one pyramid bounds columns and patches. Level 1 takes the ring in; the levels above, being
// maxima of it, then have it too. TERRAY_TILE_CORE and TERRAY_HEIGHT_APRON come from common/tiling.h.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform usampler2DArray heightCodes;
// Levels 1..5 above the source, all slots.
layout(binding = 0, r16ui) writeonly uniform uimage2DArray above1;
layout(binding = 1, r16ui) writeonly uniform uimage2DArray above2;
layout(binding = 2, r16ui) writeonly uniform uimage2DArray above3;
layout(binding = 3, r16ui) writeonly uniform uimage2DArray above4;
layout(binding = 4, r16ui) writeonly uniform uimage2DArray above5;

layout(location = 0) uniform int slot;
layout(location = 1) uniform int sourceLevel;  // 0, or a level that an earlier dispatch has built

// One maximum of each thread, then of fewer and fewer.
shared uint maxima[8][8];

const int kCore = TERRAY_TILE_CORE;
const int kApron = TERRAY_HEIGHT_APRON;

// A source texel's maximum; 0 beyond the source's last one.
uint sourceMaximum(ivec2 texel) {
    int side = kCore >> sourceLevel;
    if (texel.x >= side || texel.y >= side) return 0u;
    return texelFetch(heightCodes, ivec3(texel, slot), sourceLevel).r;
}

// Greatest of four samples in a row of the core or its ring, from the given one on.
uint rowMaximum(ivec2 first) {
    uint greatest = 0u;
    for (int x = 0; x < 4; ++x)
        greatest = max(greatest, texelFetch(heightCodes, ivec3(first + ivec2(x, 0) + kApron, slot), 0).r);
    return greatest;
}

// Maximum of a 2 x 2 quad of source texels; of samples, with the ring around them.
uint quadMaximum(ivec2 quad) {
    ivec2 corner = 2 * quad;
    if (sourceLevel == 0) {
        return max(max(rowMaximum(corner + ivec2(-1, -1)), rowMaximum(corner + ivec2(-1, 0))),
                   max(rowMaximum(corner + ivec2(-1, 1)), rowMaximum(corner + ivec2(-1, 2))));
    }
    return max(max(sourceMaximum(corner), sourceMaximum(corner + ivec2(1, 0))),
               max(sourceMaximum(corner + ivec2(0, 1)), sourceMaximum(corner + ivec2(1, 1))));
}

// Whether a texel exists `levels` above the source.
bool inside(ivec2 texel, int levels) {
    int side = kCore >> (sourceLevel + levels);
    return texel.x < side && texel.y < side;
}

// Greatest of the 2 x 2 shared maxima whose lower corner is `corner` and which lie `step` apart.
uint sharedMaximum(ivec2 corner, int step) {
    return max(max(maxima[corner.y][corner.x], maxima[corner.y][corner.x + step]),
               max(maxima[corner.y + step][corner.x], maxima[corner.y + step][corner.x + step]));
}

void main() {
    ivec2 thread = ivec2(gl_LocalInvocationID.xy);
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);  // of the second level above the source

    // Two levels from this thread's own texels.
    uint greatest = 0u;
    for (int y = 0; y < 2; ++y) {
        for (int x = 0; x < 2; ++x) {
            ivec2 quad = 2 * texel + ivec2(x, y);
            uint quadGreatest = quadMaximum(quad);
            if (inside(quad, 1)) imageStore(above1, ivec3(quad, slot), uvec4(quadGreatest));
            greatest = max(greatest, quadGreatest);
        }
    }
    if (inside(texel, 2)) imageStore(above2, ivec3(texel, slot), uvec4(greatest));
    maxima[thread.y][thread.x] = greatest;
    barrier();

    // Three more from the group's: every second, fourth, eighth thread keeps the greatest of its square.
    for (int levels = 3; levels <= 5; ++levels) {
        int step = 1 << (levels - 3);
        bool keeps = all(equal(thread & (2 * step - 1), ivec2(0)));
        if (keeps) {
            greatest = sharedMaximum(thread, step);
            maxima[thread.y][thread.x] = greatest;
            ivec2 above = texel >> (levels - 2);
            if (inside(above, levels)) {
                if (levels == 3) imageStore(above3, ivec3(above, slot), uvec4(greatest));
                if (levels == 4) imageStore(above4, ivec3(above, slot), uvec4(greatest));
                if (levels == 5) imageStore(above5, ivec3(above, slot), uvec4(greatest));
            }
        }
        barrier();
    }
}
