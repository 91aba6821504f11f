#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/json.h"
#include "preprocess/dataset_archives.h"

namespace terray {

/// One level of an archive.
struct LevelInfo {
    uint64_t tiles = 0;
    uint64_t bytes = 0;  ///< of payloads
};

/// What can be said of an archive without reading its tiles.
struct ArchiveInfo {
    uint64_t fileBytes = 0;
    std::vector<LevelInfo> levels;  ///< level 0 first

    [[nodiscard]] uint64_t tiles() const;
    [[nodiscard]] uint64_t tileBytes() const;
};

struct DatasetInfo {
    std::string directory;
    DatasetMetadata metadata;
    ArchiveInfo heights;
    std::optional<ArchiveInfo> imagery;

    /// Bytes of the height tiles as bare 16-bit cores over what they take.
    [[nodiscard]] double heightCompression() const;
    /// Bytes of the imagery tiles as bare 8-bit RGB cores over what they take; 0 without imagery.
    [[nodiscard]] double imageryCompression() const;
};

/// Throws Error(dataset) when a directory of an archive is damaged.
[[nodiscard]] DatasetInfo inspectDataset(const DatasetArchives& dataset);
[[nodiscard]] Json toJson(const DatasetInfo& info);
/// For people, several lines.
[[nodiscard]] std::string toText(const DatasetInfo& info);

}  // namespace terray
