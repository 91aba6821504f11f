#pragma once

#include <filesystem>
#include <optional>

#include "common/dataset_metadata.h"
#include "common/pmtiles.h"

namespace terray {

/// A dataset directory opened for inspection.
struct DatasetArchives {
    std::filesystem::path directory;
    DatasetMetadata metadata;
    PmtilesReader heights;
    std::optional<PmtilesReader> imagery;
};

/// Opens the archives of a dataset and reads their metadata; both archives must carry the same.
/// Throws Error(dataset) when there is none, or one is truncated, damaged in its header or of another format version.
[[nodiscard]] DatasetArchives openDataset(const std::filesystem::path& directory);

}  // namespace terray
