#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "common/dataset_metadata.h"
#include "common/pmtiles.h"
#include "preprocess/build_estimate.h"
#include "preprocess/build_observer.h"
#include "preprocess/ranks.h"
#include "preprocess/raster_source.h"

namespace terray {

/// Opens the photo that goes over the heights once it is known where these lie.
using OpenPhoto = std::function<std::unique_ptr<ColourSource>(const Tiling& tiling, const HeightGridInfo& heights)>;

/// How a dataset is to be built. Only `optionsText`, `nodataPolicy`, `maxHeightError` and `quantum` show in the result;
/// all else changes time and memory.
struct BuildRequest {
    std::filesystem::path out;
    bool replace = false;  ///< an old dataset at `out` may go (--force)
    bool resume = false;   ///< an unfinished build beside `out` may be gone on with (--resume)
    int jobs = 1;
    uint64_t memoryBytes = uint64_t{1} << 30;
    std::string optionsText;             ///< DatasetMetadata::options
    std::string nodataPolicy = "holes";  ///< DatasetMetadata::nodataPolicy
    /// Metres that no finest height may be off by; the quantum is then twice that. None: half of each tile's code step.
    std::optional<double> maxHeightError;
    std::optional<double> quantum;            ///< metres; none: by maxHeightError, else chosen by chooseQuantum()
    std::optional<uint32_t> blockDepth;       ///< levels in a block instead of the planned ones
    const std::atomic<bool>* stop = nullptr;  ///< once true the build ends with Error(interrupted)
    BuildObserver* observer = nullptr;        ///< told of progress; nullptr: nobody
    /// The processes that build it together, each of which calls with the same request; nullptr: this one alone. The
    /// one that leads makes `out`; all others return with an empty summary.
    Ranks* ranks = nullptr;
};

/// What a build made and what it cost.
struct BuildSummary {
    DatasetMetadata metadata;
    uint64_t heightBytes = 0;   ///< of heights.pmtiles
    uint64_t imageryBytes = 0;  ///< of imagery.pmtiles
    int processes = 1;
    int jobs = 1;        ///< threads used by the leading one
    double seconds = 0;  ///< from first to last
    /// Seconds summed over all threads, by BuildStep.
    std::array<double, kBuildStepNames.size()> stepSeconds{};
};

/// Builds a dataset directory from heights and, if `openPhoto` is there, a photo. All or nothing: see OutputDirectory.
///
/// The same sources and options give the same bytes, whatever the jobs, the memory or the order in which threads run,
/// and however often a build was killed and gone on with. What ends a build after its first block is on the disk, an
/// Error or the process's death, leaves OUT.partial for a later call with `resume`, which refuses (Error(usage)) when
/// the sources, the options or the program are others than those that began it. Throws Error: usage (memory, resume),
/// input, output, georeference, unsupported, interrupted.
[[nodiscard]] BuildSummary buildDataset(const HeightSource& heights, const OpenPhoto& openPhoto,
                                        const BuildRequest& request);

/// What buildDataset() with the same arguments would cost; touches nothing. Throws Error as that does for what it
/// cannot use, save for the output.
[[nodiscard]] BuildEstimate estimateDataset(const HeightSource& heights, const OpenPhoto& openPhoto,
                                            const BuildRequest& request);

/// Height quantum for a source: 1 cm; 1 mm for floats that lie half a metre apart or closer, as lidar does.
[[nodiscard]] double chooseQuantum(const HeightGridInfo& heights);

/// What an archive's header says beside its offsets: zoom range, bounds and centre. Bounds across the
/// antimeridian keep west > east. Without a coordinate system: the world.
[[nodiscard]] PmtilesHeader archiveHeader(const DatasetMetadata& metadata, uint32_t finestLevel);

}  // namespace terray
