#pragma once

#include "client/render/cast_frame.h"
#include "client/render/program_cache.h"

namespace terray {

/// Draws nodes by methods that rasterise geometry of their own (MethodTiles::draw), into the raster launch's targets,
/// and the sides of their boxes, where ground that is cut by a node's border shows (level jumps, the dataset's edge).
///
/// GL thread only.
class GeometryPass {
  public:
    /// @param boxes  the raster launch's: 36 indices of bytes, the first 24 those of the side faces; outlives this
    GeometryPass(const ShaderLibrary& shaders, const GlVertexArray& boxes);

    /// Once a frame, ahead of its draws: programs and what they read.
    void begin(const CastFrame& frame);
    /// The march's framebuffer must be bound, depth test GREATER with writes on, front faces clockwise.
    void draw(const CastFrame& frame, size_t node);

  private:
    /// The programs of a method; each is compiled when it is first drawn.
    struct Programs {
        ProgramCache surface;  ///< the method's triangles
        ProgramCache sides;    ///< the sides of a node's box
    };
    void drawSides(const CastFrame& frame, const GlProgram& program, size_t node);
    void drawInside(const GlProgram& program, size_t node);
    void drawSurface(const CastFrame& frame, const GlProgram& program, size_t node);

    const GlVertexArray& boxes_;
    Programs hull_;
    Programs mesh_;
    ProgramCache hullInside_;  ///< from an eye over the node, below the pushed-up mesh
    FeatureSet features_;
};

}  // namespace terray
