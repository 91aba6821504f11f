// methods/mesh.vert: a vertex of a tile's triangulation (TerrainMesh): its number is its place, its height is fetched.
#include "heights.glsl"
#include "methods/geometry.glsl"

out float gl_ClipDistance[4];

// TerrainMesh: blocks of 128 x 128 cells, 4 in a row; in each 130 x 130 places, the first at -1, -1.
const int kBlock = 128;
const int kStride = 130;

ivec2 sampleOf(int vertex) {
    int block = vertex / (kStride * kStride);
    int place = vertex % (kStride * kStride);
    return ivec2(block & 3, block >> 2) * kBlock + ivec2(place % kStride, place / kStride) - 1;
}

// A sample without surface continues at the mean of its neighbours.
float heightOf(ivec2 cell, uint slot) {
    float code = float(blockMaximum(cell, slot, 0));
    if (code > 0.0) return code;
    float sum = 0.0;
    float count = 0.0;
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
            float near = float(blockMaximum(cell + ivec2(x, y), slot, 0));
            sum += near;
            count += near > 0.0 ? 1.0 : 0.0;
        }
    return sum / max(count, 1.0);
}

void main() {
    NodeParameters node = nodes[nodeIndex];
    ivec2 cell = sampleOf(gl_VertexID);
    vec2 texel = vec2(cell) + 0.5;
    gl_Position = clipPosition(seenPoint(metresFromEye(node, vec3(texel, heightOf(cell, node.source.x)))));
    gl_ClipDistance[0] = texel.x - node.boxMin.x;
    gl_ClipDistance[1] = node.boxMax.x - texel.x;
    gl_ClipDistance[2] = texel.y - node.boxMin.y;
    gl_ClipDistance[3] = node.boxMax.y - texel.y;
}
