#pragma once

#include "client/render/shader_library.h"

namespace terray {

/// What a frame's programs contain. Each field adds a texture, a buffer or an output, so each is a compile-time define;
/// what is off is not compiled, not allocated, not run.
struct FeatureSet {
    bool imagery = false;     ///< TERRAY_IMAGERY: the photo's texture array and the footprint (paper 001, section 3.3)
    bool statistics = false;  ///< TERRAY_STATISTICS: steps per ray, counted into an image
    bool normals = false;     ///< TERRAY_NORMALS: an output of world normals beside colour
    bool signalSky = false;   ///< TERRAY_SIGNAL_SKY: pure magenta instead of sky, to count pixels without ground

    auto operator<=>(const FeatureSet&) const = default;

    /// All defines, each 0 or 1, that any shader of this set is compiled with.
    [[nodiscard]] ShaderDefines defines() const;
};

}  // namespace terray
