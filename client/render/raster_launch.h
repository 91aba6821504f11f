#pragma once

#include <array>
#include <memory>

#include "client/render/cast_frame.h"
#include "client/render/geometry_pass.h"
#include "client/render/program_cache.h"

namespace terray {

/// Casts rays by rasterising boxes (paper 001, section 3.4): node by node, front to back, an ID pass with the depth
/// test on and depth writes off, then the march over the back faces with the test set to pass and writes on. Without
/// the ID pass the depth test itself keeps the nearest hit.
///
/// GL thread only.
class RasterLaunch {
  public:
    explicit RasterLaunch(const ShaderLibrary& shaders);

    /// Fills hit, node and, with statistics, steps of the targets. Nodes that CastFrame::rasterised names are drawn by
    /// their geometry instead of their boxes.
    void cast(const CastFrame& frame);
    /// Fills colour and, with normals, normal. What the resolve shader reads must be bound.
    void resolve(const CastFrame& frame);
    /// Runs a program over every pixel of a framebuffer.
    void drawScreen(const GlProgram& program, const GlFramebuffer& framebuffer);

    [[nodiscard]] static uint64_t bufferBytes();

  private:
    void draw(const GlProgram& program, const GlFramebuffer& framebuffer, size_t node);
    void castRays(const CastFrame& frame, const RasterTargets& targets, size_t node);
    void drawGeometry(const CastFrame& frame, const RasterTargets& targets, size_t node);

    ProgramCache idPrograms_;
    ProgramCache marchPrograms_;
    ProgramCache resolvePrograms_;
    GlBuffer boxIndices_;
    GlVertexArray vertexArray_;
    const ShaderLibrary& shaders_;
    std::unique_ptr<GeometryPass> geometry_;  ///< from the first frame of such a method on
};

}  // namespace terray
