#pragma once

#include <mutex>
#include <unordered_map>

#include "client/stream/dataset_source.h"

namespace terray {

/// A dataset as it would be had it been built with a coarser quantum: each stored height rounded to the new steps,
/// bounds and errors of records measured and widened accordingly. Shows what height quantisation costs without a second
/// build; rounding what was rounded before adds up to half a stored step.
class RequantisedSource final : public TileSource {
  public:
    /// @param source  outlives this object  @param quantum  metres, not below the dataset's own
    RequantisedSource(const TileSource& source, double quantum);

    [[nodiscard]] const DatasetMetadata& metadata() const override { return metadata_; }
    [[nodiscard]] Result<Bytes> read(TileLayer layer, const TileId& id) const override;
    [[nodiscard]] std::string contentHash() const override;

  private:
    [[nodiscard]] Result<HeightTile> requantised(const TileId& id) const;
    [[nodiscard]] Result<HeightRecord> recordOf(const TileId& id) const;

    const TileSource& source_;
    DatasetMetadata metadata_;
    mutable std::mutex mutex_;
    mutable std::unordered_map<TileId, HeightRecord> records_;
};

}  // namespace terray
