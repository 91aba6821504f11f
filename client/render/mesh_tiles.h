#pragma once

#include <utility>
#include <vector>

#include "client/render/method_tiles.h"
#include "client/render/terrain_mesh.h"

namespace terray {

/// A triangulation of each height tile (TerrainMesh), made on the CPU when the tile is loaded: 6 bytes a triangle,
/// since a vertex is its place in the grid, and the vertex stage fetches its height from the tile. Of Method::hybrid it
/// is made when it is first drawn, and its triangles are estimated until then.
class MeshTiles final : public MethodTiles {
  public:
    MeshTiles(const MethodScene& scene, uint32_t slots);
    void build(const PreparedTile& tile) override;
    void draw(const interop::NodeParameters& node) const override;
    [[nodiscard]] uint64_t triangles(const interop::NodeParameters& node) const override;
    [[nodiscard]] bool isMade(const interop::NodeParameters& node) const override;
    [[nodiscard]] float slack(uint32_t slot) const override;
    [[nodiscard]] uint64_t takeTriangles() const override { return std::exchange(drawn_, 0); }
    [[nodiscard]] uint64_t bytes() const override { return bytes_; }
    [[nodiscard]] double bytesPerTriangle() const override;

  private:
    struct Mesh {
        GlBuffer indices;  ///< none: not made yet
        std::array<uint32_t, TerrainMesh::kBlocks + 1> starts{};
        MeshTolerance tolerance;
        bool holed = false;
        GLuint heightTexture = 0;
        double estimate = 0;  ///< triangles
    };
    [[nodiscard]] MeshTolerance toleranceOf(const PreparedTile& tile) const;
    void make(Mesh& mesh, const Grid<uint16_t>& codes) const;

    MethodScene scene_;
    mutable std::vector<Mesh> meshes_;  ///< by slot
    GlVertexArray vertexArray_;
    mutable uint64_t bytes_ = 0;
    mutable uint64_t drawn_ = 0;
};

}  // namespace terray
