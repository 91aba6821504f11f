#pragma once

#include <utility>
#include <vector>

#include "client/render/method_tiles.h"
#include "client/render/terrain_mesh.h"

namespace terray {

/// A triangulation of each height tile (TerrainMesh), made on the CPU when the tile is loaded: 6 bytes a triangle,
/// since a vertex is its place in the grid, and the vertex stage fetches its height from the tile.
class MeshTiles final : public MethodTiles {
  public:
    MeshTiles(const MethodScene& scene, uint32_t slots);
    void build(const PreparedTile& tile) override;
    void bind() const override {}
    void draw(const interop::NodeParameters& node) const override;
    [[nodiscard]] float slack(uint32_t slot) const override;
    [[nodiscard]] uint64_t takeTriangles() const override { return std::exchange(drawn_, 0); }
    [[nodiscard]] uint64_t bytes() const override { return bytes_; }
    [[nodiscard]] double bytesPerTriangle() const override;

    /// Of a slot's tile.
    [[nodiscard]] uint64_t triangles(uint32_t slot) const { return meshes_.at(slot).starts.back() / 3; }

  private:
    struct Mesh {
        GlBuffer indices;
        std::array<uint32_t, TerrainMesh::kBlocks + 1> starts{};
        float tolerance = 0;  ///< codes
        bool holed = false;
    };
    [[nodiscard]] MeshTolerance toleranceOf(const PreparedTile& tile) const;

    MethodScene scene_;
    std::vector<Mesh> meshes_;  ///< by slot
    GlVertexArray vertexArray_;
    uint64_t bytes_ = 0;
    mutable uint64_t drawn_ = 0;
};

}  // namespace terray
