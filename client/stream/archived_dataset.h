#pragma once

#include <functional>
#include <optional>

#include "client/stream/dataset_source.h"
#include "common/pmtiles.h"

namespace terray {

/// The two archives of a dataset, checked against each other, over whatever their bytes come from.
class ArchivedDataset {
  public:
    struct Place {
        std::string name;  ///< of the dataset, for messages: a directory or an address
        /// Opens "heights.pmtiles" or "imagery.pmtiles" of it.
        std::function<Result<std::unique_ptr<ByteSource>>(const char* file)> open;
        std::string remedy;  ///< what to do when an archive cannot be opened
    };
    /// Throws Error(dataset) when there is none, it is damaged, or has another format version; the message says what
    /// to do. Passes on what `place.open` throws.
    explicit ArchivedDataset(const Place& place);

    [[nodiscard]] const DatasetMetadata& metadata() const { return metadata_; }
    /// The archive of a layer; nullptr for imagery where the dataset has none.
    [[nodiscard]] const PmtilesReader* archive(TileLayer layer) const;
    /// As TileSource::read, through the archive's own ByteSource.
    [[nodiscard]] Result<Bytes> read(TileLayer layer, const TileId& id) const;
    /// Why a tile that the archive does not have could not be read.
    [[nodiscard]] static Failure missing(const PmtilesReader& archive, const TileId& id);
    /// As TileSource::contentHash. Throws Error(dataset) when the directories cannot be read.
    [[nodiscard]] std::string contentHash() const;

  private:
    ArchivedDataset(const Place& place, PmtilesReader heights);

    DatasetMetadata metadata_;
    PmtilesReader heights_;
    std::optional<PmtilesReader> imagery_;
};

}  // namespace terray
