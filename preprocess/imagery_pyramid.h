#pragma once

#include <cstdint>

#include "preprocess/pyramid_blocks.h"
#include "preprocess/raster_source.h"

namespace terray {

/// Builds all tiles of the photo pyramid from one pass over the source, block by block, into `blocks`. The
/// root stores its coarser mips too.
///
/// @param tiling  of the heights; @param samples  of their finest level: photo beyond their ground is not taken
/// @param depth   levels in a block (planWork)
/// @param blocks  new, with the extent that imageryExtent() tells
/// @return        tiles made
/// Throws Error(input) when the source cannot be read, Error(georeference) when no texel of it lies over the heights,
/// Error(unsupported) when this build has no BC1 encoder.
[[nodiscard]] uint64_t buildImageryPyramid(const ColourSource& source, const Tiling& tiling, GridSize samples,
                                           uint32_t depth, PyramidBlocks& blocks, BuildContext& context);

/// How far the photo's pyramid reaches over heights of `samples` finest samples.
[[nodiscard]] PyramidExtent imageryExtent(const Tiling& tiling, GridSize samples, uint32_t imageryLevel);

}  // namespace terray
