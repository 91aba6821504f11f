#pragma once

#include <vector>

#include <glm/vec4.hpp>

#include "client/render/cast_frame.h"
#include "client/render/program_cache.h"

namespace terray {

/// Casts rays by dispatches alone (design, section 5): each work group bins the nodes' boxes to its 8 x 8 pixels and
/// marches its rays through them, front to back, until the first hit. Nothing is rasterised, no depth or ID texture
/// exists. The march is the raster launch's own (shaders/march.glsl), and so is the image.
///
/// GL thread only.
class ComputeLaunch {
  public:
    explicit ComputeLaunch(const ShaderLibrary& shaders);

    /// Fills hit, node and, with statistics, steps of the targets.
    void cast(const CastFrame& frame);
    /// Fills colour and, with normals, normal. What the resolve shader reads must be bound.
    void resolve(const CastFrame& frame);

    /// Bytes of the buffer of boxes.
    [[nodiscard]] uint64_t bufferBytes() const { return capacity_ * sizeof(glm::vec4); }

  private:
    void uploadBoxes(const CastFrame& frame);

    ProgramCache marchPrograms_;
    ProgramCache resolvePrograms_;
    GlBuffer boxBuffer_;
    std::vector<glm::vec4> boxes_;
    uint64_t capacity_ = 0;
};

}  // namespace terray
