#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "client/render/cast_frame.h"
#include "client/render/program_cache.h"
#include "common/overlay_mesh.h"

namespace terray {

/// Draws triangles into a resolved picture of a terrain: whatever the terrain's hits show to be behind ground is left
/// out, and among themselves triangles hide each other by a depth buffer of their own (FrameTargets::overlay).
///
/// Hits, nodes and normals that the targets hold stay the terrain's; only colour is drawn. GL thread only.
class OverlayPass {
  public:
    /// @param shaders  outlives the pass
    explicit OverlayPass(const ShaderLibrary& shaders);

    /// Uploads the meshes, in place of those before.
    void setMeshes(std::span<const OverlayMesh> meshes);

    /// @param frame  resolved; its frame buffer, hit and node textures and viewport are bound
    void draw(const CastFrame& frame);

    /// Of vertices and indices.
    [[nodiscard]] uint64_t bytes() const { return bytes_; }

  private:
    struct Mesh {
        glm::dvec3 origin;
        glm::vec3 colour;
        double size;
        double leastPixels;
        GlBuffer vertices;
        GlBuffer indices;
        GLsizei count;
    };
    void draw(const Mesh& mesh, const View& view) const;

    ProgramCache programs_;
    GlVertexArray vertexArray_;
    std::vector<Mesh> meshes_;
    uint64_t bytes_ = 0;
};

}  // namespace terray
