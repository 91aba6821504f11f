#pragma once

#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "client/engine/engine.h"
#include "common/reference/picture_error.h"
#include "common/reference/pixel_error.h"

namespace terray {

// What measurements of errors do with a frame.

/// Draws a frame with all of its tiles. Throws Error(dataset) when one could not be had: the figures would describe
/// another scene.
FrameReport drawWhole(Engine& engine, const Camera& camera);

/// What the last frame shows at these pixels, row 0 at the top.
[[nodiscard]] std::vector<DrawnPixel> drawnPixels(const Engine& engine, std::span<const glm::ivec2> pixels);

/// For GroundCaster: metres, just below the lowest ground, so that rays along it do not end by rounding.
[[nodiscard]] double floorBelow(const DatasetMetadata& metadata);

/// FLIP between two pictures, mean over pixels.
[[nodiscard]] double meanFlip(GridView<const Rgba> reference, GridView<const Rgba> test);

/// Nothing is left out that the finest samples hold: bilinear, by the pyramid, tolerance of heights as given (pixels).
[[nodiscard]] EngineOptions finestOf(const EngineOptions& base, double tolerance);

}  // namespace terray
