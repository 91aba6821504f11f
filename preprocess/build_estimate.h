#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "preprocess/block_plan.h"
#include "preprocess/raster_source.h"

namespace terray {

/// What a build will probably cost.
struct BuildEstimate {
    uint64_t heightTiles = 0;   ///< at most: those of squares without data are not stored
    uint64_t imageryTiles = 0;  ///< likewise
    uint64_t archiveBytes = 0;  ///< of both archives
    uint64_t diskBytes = 0;     ///< at its fullest, temporary files included
    uint64_t memoryBytes = 0;   ///< of all threads, libraries included
    double seconds = 0;
    int jobs = 1;
};

/// Tiles of all levels, none left out.
[[nodiscard]] uint64_t tilesOf(const PyramidExtent& extent);

/// What is to be built.
struct EstimateInput {
    const HeightSource& heights;
    const ColourSource* photo = nullptr;  ///< none: heights alone
    Tiling tiling;
    double quantum = 0.01;  ///< metres
    WorkPlan work;
    uint64_t memoryBytes = 0;  ///< to stay within
};

/// Reads and encodes a few tiles that lie evenly over the ground, and takes all others to be like them: right to some
/// ten per cent for even ground, worse where a source is quick here and slow there. Takes about a second.
/// Throws Error(input) when the sources cannot be read.
[[nodiscard]] BuildEstimate estimateBuild(const EstimateInput& input);

/// Throws Error(output) when the disk that `out` is to lie on has less room than four fifths of what the build will
/// probably need: less is a lost case, more may do.
void requireSpace(const BuildEstimate& estimate, const std::filesystem::path& out);

/// The estimate for people, a few lines.
[[nodiscard]] std::string toText(const BuildEstimate& estimate, const std::filesystem::path& out);

}  // namespace terray
