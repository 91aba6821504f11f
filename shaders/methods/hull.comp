// methods/hull.comp: the pushed-up mesh over a height tile (paper 002, section 3; HullTiles). Two dispatches: each quad's push,
// then each vertex's height. Frame: tile; heights in codes.
#include "heights.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(std430, binding = 0) buffer PushBuffer { float pushes[]; };
layout(binding = 0, r32f) writeonly uniform image2DArray hullImage;
layout(location = 0) uniform ivec2 tile;  // slot, quads along the side
layout(location = 1) uniform int dispatch;

// Above the mesh's own rounding: heights below 2^17 have 7 bits behind the point, planes a few roundings of these.
const float kMargin = 0.0625;
// Below every code: where there is no ground.
const float kNone = -65536.0;

float codeAt(ivec2 cell) { return float(blockMaximum(cell, uint(tile.x), 0)); }

// Greatest code of the four cells that touch a corner of cells.
float cornerCode(ivec2 corner) {
    return max(max(codeAt(corner - 1), codeAt(corner - ivec2(0, 1))), max(codeAt(corner - ivec2(1, 0)), codeAt(corner)));
}

// Step one: a vertex on the ground. Where no ground is near it lies at the lowest code.
float groundAt(ivec2 vertex) { return cornerCode(vertex * (kCore / tile.y)); }

// Step two: how far ground lies above a quad's two triangles. By cells, each with the highest code that touches a corner.
float pushOf(ivec2 quad) {
    int cells = kCore / tile.y;
    float h00 = groundAt(quad), h10 = groundAt(quad + ivec2(1, 0));
    float h01 = groundAt(quad + ivec2(0, 1)), h11 = groundAt(quad + ivec2(1, 1));
    float push = kNone;
    for (int y = 0; y < cells; ++y)
        for (int x = 0; x < cells; ++x) {
            ivec2 cell = quad * cells + ivec2(x, y);
            if (codeAt(cell) == 0.0) continue;
            for (int i = 0; i < 4; ++i) {
                ivec2 corner = ivec2(x, y) + ivec2(i & 1, i >> 1);
                vec2 at = vec2(corner) / float(cells);
                float northWest = h00 + at.x * (h10 - h00) + at.y * (h01 - h00);
                float southEast = h11 + (1.0 - at.x) * (h01 - h11) + (1.0 - at.y) * (h10 - h11);
                // A cell on the diagonal lies below both planes.
                int side = x + y - (cells - 1);
                float plane = side < 0 ? northWest : side > 0 ? southEast : min(northWest, southEast);
                push = max(push, cornerCode(quad * cells + corner) - plane);
            }
        }
    return push == kNone ? kNone : max(push, 0.0) + kMargin;
}

// Step three: a vertex as high as the highest of the quads around it has it.
float raisedVertex(ivec2 vertex) {
    float push = kNone;
    for (int i = 0; i < 4; ++i) {
        ivec2 quad = vertex - ivec2(i & 1, i >> 1);
        if (any(lessThan(quad, ivec2(0))) || any(greaterThanEqual(quad, ivec2(tile.y)))) continue;
        push = max(push, pushes[quad.y * tile.y + quad.x]);
    }
    return push == kNone ? kNone : groundAt(vertex) + push;
}

void main() {
    ivec2 place = ivec2(gl_GlobalInvocationID.xy);
    if (dispatch == 0) {
        if (all(lessThan(place, ivec2(tile.y)))) pushes[place.y * tile.y + place.x] = pushOf(place);
    } else if (all(lessThanEqual(place, ivec2(tile.y)))) {
        imageStore(hullImage, ivec3(place, tile.x), vec4(raisedVertex(place)));
    }
}
