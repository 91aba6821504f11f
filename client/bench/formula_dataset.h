#pragma once

#include <functional>
#include <map>
#include <mutex>

#include "client/stream/dataset_source.h"

namespace terray {

/// The finest samples beneath a sample of some level: what its tile stores of them.
struct FormulaCell {
    double mean = 0;  ///< metres; NaN: no surface
    double low = 0;
    double high = 0;
};

/// A dataset of heights in main memory, made from a formula as FORMAT.md says: coarser samples are means, records hold
/// measured bounds, and errors by surfaceRangeBound(), which needs no other level. Tiles are made when they are first
/// read, so it may be as large as one likes.
class FormulaDataset final : public TileSource {
  public:
    struct Shape {
        GridSize samples{512, 512};
        double spacing = 1;  ///< metres between the finest samples
        double west = 0;     ///< of the upper left corner, metres
        double north = 0;
        double quantum = 0.01;
        uint32_t levels = 0;               ///< at least so many beside the coarsest, more where the samples need them
        bool errorsHoldEverywhere = true;  ///< false: as of an older build's dataset, at samples only
    };
    /// Height in metres of a finest sample, NaN: no surface.
    using Heights = std::function<double(int64_t column, int64_t row)>;
    /// Of a sample `up` levels above the finest one. Called from several threads at once.
    using Cells = std::function<FormulaCell(uint32_t up, int64_t column, int64_t row)>;

    /// All samples of all levels are kept, 32 bytes for each finest one.
    FormulaDataset(const Shape& shape, const Heights& heights);
    /// For datasets too large for that.
    FormulaDataset(const Shape& shape, Cells cells);

    [[nodiscard]] const DatasetMetadata& metadata() const override { return metadata_; }
    [[nodiscard]] Result<Bytes> read(TileLayer layer, const TileId& id) const override;
    [[nodiscard]] std::string contentHash() const override { return "formula"; }

  private:
    [[nodiscard]] FormulaCell cell(const TileId& tile, int column, int row) const;
    /// Of a tile, apron included.
    [[nodiscard]] Grid<FormulaCell> cells(const TileId& tile) const;
    /// Without its children's records.
    [[nodiscard]] HeightTile alone(const TileId& id) const;
    [[nodiscard]] HeightRecord recordOf(const TileId& id) const;

    Cells cells_;
    DatasetMetadata metadata_;
    mutable std::mutex mutex_;
    mutable std::map<TileId, HeightRecord> records_;
};

}  // namespace terray
