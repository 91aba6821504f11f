#pragma once

#include <cstdint>

#include "preprocess/pyramid_blocks.h"
#include "preprocess/raster_source.h"

namespace terray {

/// Builds all tiles of the photo pyramid from one pass over the source, block by block, into `blocks`. The
/// root stores its coarser mips too.
///
/// @param extent  that imageryExtent() tells: photo beyond it is not taken
/// @param depth   levels in a block (planWork)
/// @param blocks  new, with that extent
/// @return        tiles made
/// Throws Error(input) when the source cannot be read, Error(georeference) when no texel of it lies over the heights,
/// Error(unsupported) when this build has no BC1 encoder.
[[nodiscard]] uint64_t buildImageryPyramid(const ColourSource& source, const PyramidExtent& extent, uint32_t depth,
                                           PyramidBlocks& blocks, BuildContext& context);

/// How far the photo's pyramid reaches over heights of `samples` finest samples, and what of it the photo may cover.
/// The photo must overlap their ground.
[[nodiscard]] PyramidExtent imageryExtent(const Tiling& tiling, GridSize samples, const ColourSource& photo);

}  // namespace terray
