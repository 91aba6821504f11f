#pragma once

#include <functional>

#include "client/stream/dataset_source.h"
#include "common/edited_ground.h"

namespace terray {

/// What a tile's samples are after edits, on the CPU: editedHeight() at the centre of each, in the tile's edited
/// encoding; its bounds measured, its error that of the edited record. Children are those of the stored tile.
[[nodiscard]] HeightTile editedTile(const HeightTile& stored, const EditedGround& ground);

/// Place of a sample of a tile by its texel in the core, apron included.
[[nodiscard]] glm::dvec2 sampleCentre(const Tiling& tiling, const TileId& id, int64_t column, int64_t row);

/// A dataset whose tiles are edited before they are read: for oracles. Bounds in the metadata hold the edited ground.
class EditedSource final : public TileSource {
  public:
    /// @param source  outlives this object
    EditedSource(const TileSource& source, EditList edits);
    [[nodiscard]] const DatasetMetadata& metadata() const override { return metadata_; }
    [[nodiscard]] Result<Bytes> read(TileLayer layer, const TileId& id) const override;
    [[nodiscard]] std::string contentHash() const override { return "edited"; }

  private:
    const TileSource& source_;
    EditedGround ground_;
    DatasetMetadata metadata_;
};

/// Craters and strokes of all kinds that overlap, most within a rectangle, of all sizes from a part of a sample to a
/// third of it. @param uniform  a number from the first to the second
[[nodiscard]] EditList randomEdits(const std::function<double(double, double)>& uniform, const GroundRect& ground,
                                   double spacing, int count);

}  // namespace terray
