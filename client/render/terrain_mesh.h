#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/grid.h"

namespace terray {

/// How closely a height tile is triangulated.
struct MeshTolerance {
    double codes = 0;  ///< greatest distance of a sample from the triangles, straight up or down; >= 0
    /// By how much the middle of an edge of one texel sinks below a curved earth, codes; grows with the length's
    /// square.
    double sag = 0;
};

/// A restricted quadtree triangulation of a height tile (right-triangulated irregular network: Evans, Kirkpatrick,
/// Townsend 2001; the hierarchy is that of paper 001's rival, which keeps its text to itself, so the decisions are
/// ours).
///
/// Vertices are samples. Triangles cover the core and, by a strip along the west and the north border, the half cell
/// between the core's edge and the first sample; what reaches beyond the core is to be clipped. Conforming: no vertex
/// of a triangle lies within another's edge. No sample lies farther than the tolerance from the triangles that cover
/// it, measured, not estimated. A triangle is split as well where it holds samples both with and without surface; one
/// whose corner has none, not even a neighbour that has, is left out. A sample without surface beside one that has
/// continues at the mean of its neighbours.
struct TerrainMesh {
    /// Triangles are listed by blocks of 128 x 128 cells, row by row, so that 16 bits name a vertex: (row + 1) * 130 +
    /// column + 1, counted from the block's corner, -1 .. 128.
    static constexpr int kBlocksAcross = 4;
    static constexpr int kBlocks = kBlocksAcross * kBlocksAcross;
    static constexpr int kBlockSide = 128;
    static constexpr int kBlockStride = kBlockSide + 2;
    static constexpr int kBlockVertices = kBlockStride * kBlockStride;

    std::vector<uint16_t> indices;               ///< three a triangle; counter-clockwise as seen from above
    std::array<uint32_t, kBlocks + 1> starts{};  ///< of each block's indices, and the end

    [[nodiscard]] size_t triangles() const { return indices.size() / 3; }
};

/// @param codes  kHeightTileSide^2, as of HeightTile. Takes some 20 ms. Any thread.
[[nodiscard]] TerrainMesh triangulated(const Grid<uint16_t>& codes, const MeshTolerance& tolerance);

/// About how many triangles that makes, from a sixteenth of the tile in a sixteenth of the time: within a factor of 2
/// where there are thousands, and where ground is alike. Any thread.
[[nodiscard]] double estimatedTriangles(const Grid<uint16_t>& codes, const MeshTolerance& tolerance);

}  // namespace terray
