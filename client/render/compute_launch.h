#pragma once

#include <vector>

#include <glm/vec4.hpp>

#include "client/render/cast_frame.h"
#include "client/render/program_cache.h"

namespace terray {

/// Casts rays by dispatches alone (design, section 5): one bins the nodes' boxes to squares of 32 x 32 pixels, the next
/// marches each pixel's ray through its bin, front to back, until the first hit. Nothing is rasterised, no depth or ID
/// texture exists. The march is the raster launch's own (shaders/march.glsl), and so is the image.
///
/// (Binning within the marching group, in shared memory, was twice as slow on llvmpipe: its barriers keep the march's
/// variables out of registers.)
///
/// GL thread only.
class ComputeLaunch {
  public:
    explicit ComputeLaunch(const ShaderLibrary& shaders);

    /// Fills hit, node and, with statistics, steps of the targets.
    void cast(const CastFrame& frame);
    /// Fills colour and, with normals, normal. What the resolve shader reads must be bound.
    void resolve(const CastFrame& frame);
    /// Runs a program whose groups are TERRAY_GROUP_SIDE square over every pixel of the picture.
    static void dispatchScreen(const GlProgram& program, const View& view);

    /// Bytes of the buffers of boxes and bins.
    [[nodiscard]] uint64_t bufferBytes() const { return boxBuffer_.bytes + binBuffer_.bytes; }

  private:
    /// A buffer that grows; what it held is lost then.
    struct Buffer {
        GlBuffer object;
        uint64_t bytes = 0;
        void require(uint64_t needed);
    };
    void bin(const CastFrame& frame);

    ProgramCache binPrograms_;
    ProgramCache marchPrograms_;
    ProgramCache resolvePrograms_;
    Buffer boxBuffer_;
    Buffer binBuffer_;
    std::vector<glm::vec4> boxes_;
};

}  // namespace terray
