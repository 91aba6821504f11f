// methods/cones.comp: relaxed cones over the blocks of a height tile (ConeTiles). Frame: tile; heights in codes.
// Source: Policarpo and Oliveira 2007, GPU Gems 3, chapter 18, listing 18-2: rays from above the block through the ground of
// every other; where one comes out of the ground again bounds the cone.
#include "heights.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0, r16f) writeonly uniform image2DArray coneImage;
layout(location = 0) uniform ivec3 tile;  // slot, blocks along the side, reach in blocks

const float kWidest = 4096.0;  // texels a code: no bound
const float kDown = 1.0 - 1.0 / 1024.0;  // half floats round by 1 in 2048

float topOf(ivec2 block) { return float(blockMaximum(block, uint(tile.x), findMSB(kCore / tile.y))); }

bool inTile(ivec2 block) { return all(greaterThanEqual(block, ivec2(0))) && all(lessThan(block, ivec2(tile.y))); }

// The cone's width by one other block: distance and height of where the ray through its top leaves the ground.
// widest: what is known already.
float widthBy(ivec2 block, float top, ivec2 step, float highest, float widest) {
    float side = float(kCore / tile.y);
    float far = length(vec2(step));
    float height = topOf(block + step);
    // The ray comes out farther away and lower, so it bounds the cone less than the top itself would.
    if (height <= top || (far - 1.0) * side >= widest * (height - top)) return widest;
    vec2 unit = vec2(step) / far;
    float drop = (highest - height) / far;
    for (float k = 1.0; k <= float(tile.y); ++k) {
        float z = height - k * drop;
        if (z <= top) return widest;
        ivec2 place = block + ivec2(round(unit * (far + k)));
        if (!inTile(place)) return widest;
        // A block less, for rays that start anywhere in theirs.
        if (topOf(place) <= z) return min(widest, (far + k - 1.0) * side / (z - top));
    }
    return widest;
}

void main() {
    ivec2 block = ivec2(gl_GlobalInvocationID.xy);
    float top = topOf(block);
    float highest = float(blockMaximum(ivec2(0), uint(tile.x), 9));
    float widest = kWidest;
    // From near to far: near ground bounds most cones, and the rest is then soon told to be wider.
    for (int ring = 1; ring <= tile.z; ++ring)
        for (int i = -ring; i < ring; ++i)
            for (int side = 0; side < 4; ++side) {
                ivec2 step = side == 0 ? ivec2(i, -ring) : side == 1 ? ivec2(ring, i) : side == 2 ? ivec2(-i, ring) : ivec2(-ring, -i);
                if (inTile(block + step)) widest = widthBy(block, top, step, highest, widest);
            }
    imageStore(coneImage, ivec3(block, tile.x), vec4(widest * kDown));
}
