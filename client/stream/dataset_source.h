#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "common/dataset_metadata.h"
#include "common/height_tile.h"
#include "common/imagery_tile.h"
#include "common/pmtiles.h"

namespace terray {

enum class TileLayer : uint8_t { heights, imagery };

class TileReads;

/// Where stored tiles come from. Thread-safe: decode workers and the IO thread call at once.
class TileSource {
  public:
    virtual ~TileSource() = default;
    [[nodiscard]] virtual const DatasetMetadata& metadata() const = 0;
    /// The stored payload of a tile that its parent (or the metadata) says exists.
    [[nodiscard]] virtual Result<Bytes> read(TileLayer layer, const TileId& id) const = 0;
    /// Reads for the pager's IO thread, which runs many at a time; this source must outlive them. Unless a source knows
    /// better, read() is called for one after the other.
    [[nodiscard]] virtual std::unique_ptr<TileReads> startReads() const;
    /// A short text that changes whenever the content does: checksums of both archives' headers, directories and
    /// metadata.
    [[nodiscard]] virtual std::string contentHash() const = 0;
};

/// Opens a dataset directory. Throws Error(dataset) when it is none, is damaged, or has another format version; the
/// message says what to do.
[[nodiscard]] std::unique_ptr<TileSource> openLocalDataset(const std::filesystem::path& directory);

}  // namespace terray
