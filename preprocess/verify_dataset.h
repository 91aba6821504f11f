#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "preprocess/dataset_archives.h"

namespace terray {

/// Something that does not hold in a dataset.
struct Fault {
    std::string where;  ///< "heights 3/1/4", "imagery 0/0/0", or "metadata"
    std::string what;
};

struct VerifyReport {
    uint64_t heightTiles = 0;  ///< looked at
    uint64_t imageryTiles = 0;
    std::vector<Fault> faults;  ///< metadata first, then by archive and Hilbert order
};

/// Checks that every statement a dataset makes about itself holds.
///
/// Heights, each tile: checksum, id and bounds; agreement of what its parent and its metadata say of it with what it
/// says; existence of parent and children both ways; holes exactly where none of the four cells beneath has a surface,
/// and beyond the sources; each cell the mean of those beneath, to the rounding of both; its error e no less than what
/// the children prove (|h - h_child| - e_child for some cell) and no more than they allow (|h - h_child| + e_child for
/// every cell). Imagery, each tile: checksum, id, mips, and existence both ways. Whole dataset: counts, extremes,
/// errors of levels, hole samples, the archives' headers, and the text of the metadata, which both archives share. What
/// the sources held cannot be checked, since they are not there.
///
/// Uses `jobs` threads, five decoded tiles each. Throws Error(dataset) when a directory cannot be read,
/// Error(interrupted).
[[nodiscard]] VerifyReport verifyDataset(const DatasetArchives& dataset, int jobs, const std::atomic<bool>& stop);

}  // namespace terray
