#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/grid.h"
#include "common/tile_id.h"
#include "common/tiling.h"

namespace terray {

/// How far a pyramid reaches: samples and tiles of each of its levels.
struct PyramidExtent {
    uint32_t finestLevel = 0;
    GridSize samples;                   ///< of the finest level
    std::optional<GridRect> covered{};  ///< those of them that the source may have; none: all. Not empty

    [[nodiscard]] GridSize samplesAt(uint32_t level) const;
    [[nodiscard]] GridSize tilesAt(uint32_t level) const;
    /// Columns and rows of the tiles that `covered` touches: no other is ever made. A photo of a house on the map of a
    /// country has few of them, however fine it is.
    [[nodiscard]] GridRect coveredTilesAt(uint32_t level) const;
};

/// A pass over the pyramid: it takes the samples of `bottom` and makes the tiles above, up to `top()`.
///
/// Its blocks are subtrees: one for each tile of top(), with 2^depth x 2^depth tiles at the bottom, built wholly in
/// memory. The first stage reads the source and makes the tiles of the bottom too; each later one reads the level that
/// the stage below left.
struct BlockStage {
    uint32_t bottom = 0;
    uint32_t depth = 0;
    bool first = true;

    [[nodiscard]] uint32_t top() const { return bottom - depth; }
};

/// Stages from the finest level to the root, none deeper than `depth` (>= 1 unless the pyramid has one level only).
[[nodiscard]] std::vector<BlockStage> planStages(uint32_t finestLevel, uint32_t depth);

/// The blocks of a stage by their top tiles, along the Hilbert curve, so that neighbours in time are neighbours in
/// space and find what they share in the reading library's cache.
[[nodiscard]] std::vector<TileId> blocksOf(const PyramidExtent& extent, const BlockStage& stage);

/// Samples of the bottom level that a block needs, when each of its tiles is to have `apron` samples on each side.
[[nodiscard]] GridRect blockWindow(const BlockStage& stage, const TileId& top, int apron);

/// Where the core of a tile lies in the samples that a block holds of a level `above` the bottom.
/// @param column, row  of the tile within the block
[[nodiscard]] GridRect coreInBlock(const BlockStage& stage, uint32_t above, int apron, int64_t column, int64_t row);

/// A rectangle with `margin` more on each side.
[[nodiscard]] GridRect grown(const GridRect& rect, int64_t margin);

/// Bytes that one block in work takes, its samples of all levels and its buffers.
[[nodiscard]] uint64_t heightBlockBytes(uint32_t depth);
[[nodiscard]] uint64_t imageryBlockBytes(uint32_t depth);

/// How the work is divided: never changes the result, only time and memory.
struct WorkPlan {
    int jobs = 1;
    uint32_t heightDepth = 0;
    uint32_t imageryDepth = 0;
    uint64_t cacheBytes = 0;  ///< for the reading library
    std::string note;         ///< what had to be reduced, for the user; empty when nothing
};

/// The smallest --memory that a dataset can be built with.
inline constexpr uint64_t kMinMemoryBytes = 256u << 20;

/// Chooses the largest blocks, up to three levels deep, of which `jobs` fit `memoryBytes` and that still keep every
/// thread busy; then, if even the smallest blocks are too many, fewer jobs.
///
/// @param imagery    nullptr without imagery
/// @param processes  that build it together, each with `jobs` threads and `memoryBytes`
/// Throws Error(usage) below kMinMemoryBytes.
[[nodiscard]] WorkPlan planWork(int jobs, uint64_t memoryBytes, const PyramidExtent& heights,
                                const PyramidExtent* imagery, int processes = 1);
/// As planWork, for a build whose blocks were chosen by an earlier run: only the jobs are.
[[nodiscard]] WorkPlan planResumedWork(int jobs, uint64_t memoryBytes, uint32_t heightDepth,
                                       std::optional<uint32_t> imageryDepth);
/// What planWork will leave to the reading library's cache, for sources that are opened before the plan can be made.
[[nodiscard]] uint64_t cacheShare(uint64_t memoryBytes);

}  // namespace terray
