#pragma once

#include "client/render/compute_launch.h"
#include "client/render/program_cache.h"
#include "client/render/raster_launch.h"
#include "client/render/shadow_scene.h"

namespace terray {

/// How the sun casts shadows.
struct ShadowOptions {
    /// Of the sun's disc, in radians; 0: hard shadows. Seen from the earth it is 0.0093 (0.53 degrees).
    double sunDiameter = 0;
    int rays = 8;  ///< of each pixel, when the sun has a diameter
};

/// Rays from every hit to the sun (shaders/shadow.glsl), between march and resolve, by either launch.
///
/// GL thread only. Made only where shadows are drawn.
class ShadowPass {
  public:
    explicit ShadowPass(const ShaderLibrary& shaders);

    /// Fills sunLight and, with statistics, steps of the targets' shadow(). The nodes of `scene`, those in the picture
    /// first, and the hits must be bound.
    void cast(const CastFrame& frame, ShadowScene scene, const ShadowOptions& options, RasterLaunch* raster);

    [[nodiscard]] uint64_t bufferBytes() const;

  private:
    ProgramCache rasterPrograms_;
    ProgramCache computePrograms_;
    GlBuffer cellBuffer_;
    GlBuffer parameterBuffer_;
    uint64_t cellCapacity_ = 0;
};

}  // namespace terray
