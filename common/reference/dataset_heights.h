#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <mutex>
#include <unordered_map>

#include "common/dataset_metadata.h"
#include "common/height_tile.h"
#include "common/reference/reference_heights.h"

namespace terray {

/// What is told of a height that was stored rounded to its tile's step.
enum class Rounding : uint8_t {
    asStored,
    undone,  ///< moved by up to half a step, the same way each time: a height that may have been before it was rounded
};

/// The finest samples of a dataset, decoded from its tiles' cores. What exists and how high it reaches is asked of
/// each tile's parent, from the root down, and kept.
class DatasetHeights final : public ReferenceHeights {
  public:
    /// Reads the payload of a stored height tile; called from several threads at once.
    using ReadPayload = std::function<Result<Bytes>(const TileId&)>;

    DatasetHeights(const DatasetMetadata& metadata, ReadPayload readPayload, Rounding rounding = Rounding::asStored);

    [[nodiscard]] GridSize size() const override { return size_; }
    [[nodiscard]] double upperBound(const GridRect& rect) const override;
    [[nodiscard]] Grid<double> read(const GridRect& rect) const override;

  private:
    [[nodiscard]] HeightRecord recordOf(const TileId& id) const;
    [[nodiscard]] HeightTile tile(const TileId& id) const;

    GridSize size_;
    uint32_t finestLevel_;
    double quantum_;
    ReadPayload readPayload_;
    Rounding rounding_;
    mutable std::once_flag rootRead_;
    mutable HeightRecord root_;
    mutable std::mutex mutex_;
    mutable std::unordered_map<TileId, std::array<HeightRecord, 4>> children_;  ///< of tiles above the finest level
};

}  // namespace terray
