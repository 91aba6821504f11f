#pragma once

#include <cstdint>

#include "preprocess/build_context.h"
#include "preprocess/raster_source.h"

namespace terray {

/// Builds all tiles of the photo pyramid from one pass over the source, block by block, and spills them. The root
/// stores its coarser mips too.
///
/// @param tiling  of the heights; @param samples  of their finest level: photo beyond their ground is not taken
/// @param depth   levels in a block (planWork)
/// @return        tiles made
/// Throws Error(input) when the source cannot be read, Error(georeference) when no texel of it lies over the heights,
/// Error(unsupported) when this build has no BC1 encoder.
[[nodiscard]] uint64_t buildImageryPyramid(const ColourSource& source, const Tiling& tiling, GridSize samples,
                                           uint32_t depth, TileSpill& spill, BuildContext& context);

/// How far the photo's pyramid reaches over heights of `samples` finest samples.
[[nodiscard]] PyramidExtent imageryExtent(const Tiling& tiling, GridSize samples, uint32_t imageryLevel);

}  // namespace terray
