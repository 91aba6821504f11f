#pragma once

#include <cstdint>
#include <span>

#include "client/render/feature_set.h"
#include "client/render/frame_targets.h"
#include "client/render/gpu_timer.h"
#include "client/render/method_tiles.h"
#include "common/view.h"
#include "shaders/interop.h"

namespace terray {

/// One frame as the launches get it: node and frame buffers, height texture and viewport are bound already.
struct CastFrame {
    const View& view;
    std::span<const interop::NodeParameters> nodes;  ///< front to back
    FeatureSet features;
    FrameTargets& targets;
    GpuTimer* timer = nullptr;                 ///< may be null
    const MethodTiles* methodTiles = nullptr;  ///< of methods that keep something of each tile
    /// Of each node, whether the method's geometry is rasterised (1) or rays are cast (0); raster launch.
    std::span<const uint8_t> rasterised;

    void enter(GpuPass pass) const {
        if (timer != nullptr) timer->enter(pass);
    }
};

}  // namespace terray
