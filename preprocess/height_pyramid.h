#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "preprocess/pyramid_blocks.h"
#include "preprocess/raster_source.h"

namespace terray {

/// What building the heights measured.
struct HeightTotals {
    uint64_t tiles = 0;
    uint64_t holeSamples = 0;         ///< finest samples of the source without surface
    double minHeight = 0;             ///< metres, over all tiles of all levels, rounded down
    double maxHeight = 0;             ///< metres, rounded up
    std::vector<double> levelErrors;  ///< metres, greatest of each level, level 0 first
    double finestStep = 0;            ///< metres, the widest code step of the finest level
};

/// How exactly heights are to be stored.
struct HeightPrecision {
    double quantum = 0.01;           ///< metres, of HeightEncoding
    std::optional<double> maxError;  ///< metres that no finest height may be off by
};

/// Heights beyond this are an undeclared nodata value, not ground: 10,000 km.
inline constexpr float kGreatestHeight = 1e7f;

/// Builds all tiles of the height pyramid from one pass over the source, block by block, into `blocks`.
///
/// @param depth    levels in a block (planWork)
/// @param blocks   new, with the extent that heightExtent() tells
/// Throws Error(input) when the source cannot be read, holds heights beyond kGreatestHeight, has no height at all, or
/// has so great a range within a tile that 16 bits cannot keep to `maxError`.
[[nodiscard]] HeightTotals buildHeightPyramid(const HeightSource& source, uint32_t depth,
                                              const HeightPrecision& precision, PyramidBlocks& blocks,
                                              BuildContext& context);
[[nodiscard]] PyramidExtent heightExtent(const HeightGridInfo& info);

}  // namespace terray
