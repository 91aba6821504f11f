#pragma once

#include <utility>

#include "client/render/method_tiles.h"

namespace terray {

/// Of each height tile a mesh of `side` x `side` quads over its core, pushed up until no part of the ground is above it
/// (paper 002, section 3): vertices take the ground's height, each quad is raised to the highest distance of ground
/// above its two triangles, each vertex to the highest of the quads around it. Vertex (i, j) lies at tile texel (512 i
/// / side, 512 j / side); the diagonal of a quad runs from its south-west to its north-east corner.
///
/// Proved for columns and for bilinear patches: a cell's corners lie below the mesh with the highest code of the cells
/// that touch them, and between corners both surfaces are below that, mesh and bound being linear there (on the
/// diagonal, below both planes).
class HullTiles final : public MethodTiles {
  public:
    /// @param side  a power of two, 16 .. 256
    HullTiles(int side, uint32_t slots, const ShaderLibrary& shaders);
    void build(const PreparedTile& tile) override;
    void bind() const override;
    void draw(const interop::NodeParameters& node) const override;
    [[nodiscard]] uint64_t triangles(const interop::NodeParameters& node) const override;
    [[nodiscard]] uint64_t takeTriangles() const override { return std::exchange(triangles_, 0); }
    [[nodiscard]] uint64_t bytes() const override;
    [[nodiscard]] double bytesPerTriangle() const override;

    /// R32F, (side + 1)^2 texels a slot: heights of vertices in codes; below every code where no ground is near.
    [[nodiscard]] GLuint texture() const { return hulls_.name(); }

  private:
    /// Those that a node's cell touches.
    struct Quads {
        GLint column = 0;
        GLint row = 0;
        GLint columns = 0;
        GLint rows = 0;
    };
    [[nodiscard]] Quads quadsOf(const interop::NodeParameters& node) const;

    int side_;
    uint32_t slots_;
    GlTexture hulls_;
    GlBuffer pushes_;  ///< of the tile that is built: codes for each quad
    GlProgram program_;
    mutable uint64_t triangles_ = 0;
};

}  // namespace terray
