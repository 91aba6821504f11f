#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "client/bench/marched_node.h"
#include "client/stream/dataset_source.h"
#include "common/reference/pixel_error.h"

namespace terray {

/// Which numbers a march counts with.
enum class Precision : uint8_t { single, full };

/// The march of shaders/march.glsl on the CPU, step by step, over the modules of shaders/math compiled as C++. In float
/// it shows what the GPU shows, up to the GPU's own roundings. Between float and double of it lies what float
/// arithmetic costs, between double and the truth what the algorithm costs (design, section 5).
class ShaderMarch {
  public:
    /// @param source  outlives this object
    explicit ShaderMarch(const TileSource& source) : source_(source) {}

    /// What pixels of a picture of these nodes show, on all cores. Tiles that the nodes name are decoded and kept, 1.2
    /// MB each. Throws Error(dataset) when one cannot be had.
    /// @param nodes   front to back, as selected
    /// @param pixels  column and row from the top
    /// @param steps   if not empty, one for each pixel: what the shaders count, as FrameTargets::readSteps()
    [[nodiscard]] std::vector<DrawnPixel> draw(const std::vector<DrawNode>& nodes, const View& view, Surface surface,
                                               Precision precision, std::span<const glm::ivec2> pixels,
                                               std::span<uint32_t> steps = {});

  private:
    const MarchedTile& tile(const TileId& id);

    const TileSource& source_;
    std::map<TileId, std::unique_ptr<const MarchedTile>> tiles_;
};

}  // namespace terray
