#include "client/bench/formula_dataset.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "common/surface_range.h"

namespace terray {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Samples of a level that lie over ground.
GridSize samplesAt(const GridSize& finest, uint32_t up) {
    const auto coarser = [&](int64_t samples) { return (samples + (int64_t{1} << up) - 1) >> up; };
    return {coarser(finest.width), coarser(finest.height)};
}

using Pyramid = std::vector<Grid<FormulaCell>>;  ///< finest level first

FormulaCell merged(const Grid<FormulaCell>& finer, int64_t column, int64_t row) {
    FormulaCell cell{0, kNaN, kNaN};
    int count = 0;
    for (int64_t y = 2 * row; y < std::min(2 * row + 2, finer.height()); ++y)
        for (int64_t x = 2 * column; x < std::min(2 * column + 2, finer.width()); ++x) {
            const FormulaCell& part = finer.at(x, y);
            if (std::isnan(part.mean)) continue;
            cell = {cell.mean + part.mean, std::fmin(cell.low, part.low), std::fmax(cell.high, part.high)};
            ++count;
        }
    cell.mean = count > 0 ? cell.mean / count : kNaN;
    return cell;
}

std::shared_ptr<const Pyramid> pyramidOf(const GridSize& samples, const FormulaDataset::Heights& heights,
                                         uint32_t levels) {
    auto pyramid = std::make_shared<Pyramid>();
    pyramid->emplace_back(samples);
    for (int64_t y = 0; y < samples.height; ++y)
        for (int64_t x = 0; x < samples.width; ++x) {
            const double height = heights(x, y);
            pyramid->back().at(x, y) = {height, height, height};
        }
    for (uint32_t up = 1; up <= levels; ++up) {
        Grid<FormulaCell> coarser(samplesAt(samples, up));
        for (int64_t y = 0; y < coarser.height(); ++y)
            for (int64_t x = 0; x < coarser.width(); ++x) coarser.at(x, y) = merged(pyramid->back(), x, y);
        pyramid->push_back(std::move(coarser));
    }
    return pyramid;
}

uint32_t finestLevelOf(const FormulaDataset::Shape& shape) {
    return std::max(shape.levels, Tiling::levelFor(std::max(shape.samples.width, shape.samples.height)));
}

uint64_t tilesTo(uint32_t finestLevel) {
    uint64_t tiles = 0;
    for (uint32_t level = 0; level <= finestLevel; ++level) tiles += uint64_t{1} << (2 * level);
    return tiles;
}

/// How far the surface over a cell may lie from the finest one.
double surfaceRange(const Grid<FormulaCell>& cells, int64_t column, int64_t row) {
    const FormulaCell& own = cells.at(column, row);
    CellHeights<double> around = {own.mean, own.mean, own.low, own.high};
    for (int64_t y = row - 1; y <= row + 1; ++y)
        for (int64_t x = column - 1; x <= column + 1; ++x) {
            const FormulaCell& of = cells.at(x, y);
            around = {std::fmin(around.leastMean, of.mean), std::fmax(around.greatestMean, of.mean),
                      std::fmin(around.lowest, of.low), std::fmax(around.highest, of.high)};
        }
    return surfaceRangeBound({own.mean, own.mean, own.low, own.high}, around);
}

/// How far a cell lies from the finest samples beneath it.
double columnRange(const FormulaCell& cell) {
    return std::max(cell.mean - cell.low, cell.high - cell.mean);
}

}  // namespace

FormulaDataset::FormulaDataset(const Shape& shape, const Heights& heights)
    : FormulaDataset(shape, [pyramid = pyramidOf(shape.samples, heights, finestLevelOf(shape))](
                                uint32_t up, int64_t column, int64_t row) { return (*pyramid)[up].at(column, row); }) {}

FormulaDataset::FormulaDataset(const Shape& shape, Cells cells) : cells_(std::move(cells)) {
    metadata_.tiling = {shape.west, shape.north, shape.spacing, finestLevelOf(shape)};
    metadata_.samples = shape.samples;
    metadata_.quantum = shape.quantum;
    metadata_.errorsHoldEverywhere = shape.errorsHoldEverywhere;
    metadata_.heightTiles = tilesTo(metadata_.tiling.finestLevel);
    metadata_.tool = "formula";
    const HeightRecord root = recordOf({});
    TERRAY_CHECK(root.exists);
    metadata_.minHeight = double{root.minHeight} - root.error;
    metadata_.maxHeight = double{root.maxHeight} + root.error;
    metadata_.levelErrors.assign(metadata_.tiling.finestLevel + 1, root.error);
}

FormulaCell FormulaDataset::cell(const TileId& tile, int column, int row) const {
    const uint32_t up = metadata_.tiling.finestLevel - tile.level;
    const int64_t x = int64_t{tile.x} * kTileCore + column, y = int64_t{tile.y} * kTileCore + row;
    const GridSize size = samplesAt(metadata_.samples, up);
    if (x < 0 || y < 0 || x >= size.width || y >= size.height) return {kNaN, kNaN, kNaN};
    return cells_(up, x, y);
}

Grid<FormulaCell> FormulaDataset::cells(const TileId& id) const {
    Grid<FormulaCell> cells({kHeightTileSide, kHeightTileSide});
    for (int row = 0; row < kHeightTileSide; ++row)
        for (int column = 0; column < kHeightTileSide; ++column)
            cells.at(column, row) = cell(id, column - kHeightApron, row - kHeightApron);
    return cells;
}

HeightTile FormulaDataset::alone(const TileId& id) const {
    const Grid<FormulaCell> cells = this->cells(id);
    double low = kNaN, high = kNaN;
    for (const FormulaCell& of : cells.cells()) {
        low = std::fmin(low, of.mean);
        high = std::fmax(high, of.mean);
    }
    HeightTile tile{.id = id, .codes = Grid<uint16_t>({kHeightTileSide, kHeightTileSide}, kNoSurface)};
    if (std::isnan(low)) return tile;
    tile.encoding = HeightEncoding::covering(low, high, metadata_.quantum);
    double rounding = 0, apart = 0;
    const bool finest = id.level == metadata_.tiling.finestLevel;
    constexpr GridRect kCore = {kHeightApron, kHeightApron, kTileCore, kTileCore};
    for (int64_t row = 0; row < kHeightTileSide; ++row)
        for (int64_t column = 0; column < kHeightTileSide; ++column) {
            const double mean = cells.at(column, row).mean;
            if (std::isnan(mean)) continue;
            const uint16_t code = tile.encoding.code(mean);
            tile.codes.at(column, row) = code;
            rounding = std::max(rounding, std::abs(tile.encoding.height(code) - mean));
            const bool inCore = !intersection({column, row, 1, 1}, kCore).empty();
            if (inCore && !finest)
                apart = std::max(apart, metadata_.errorsHoldEverywhere ? surfaceRange(cells, column, row)
                                                                       : columnRange(cells.at(column, row)));
        }
    tile.record = measureRecord(tile.codes, tile.encoding, floatAtLeast(apart + rounding));
    return tile;
}

HeightRecord FormulaDataset::recordOf(const TileId& id) const {
    {
        const std::scoped_lock lock(mutex_);
        if (const auto known = records_.find(id); known != records_.end()) return known->second;
    }
    const HeightRecord record = alone(id).record;
    const std::scoped_lock lock(mutex_);
    return records_[id] = record.exists ? record : HeightRecord();
}

Result<Bytes> FormulaDataset::read(TileLayer layer, const TileId& id) const {
    HeightTile tile = layer == TileLayer::heights ? alone(id) : HeightTile();
    if (!tile.record.exists) return Failure{"there is no tile " + toString(id)};
    for (uint32_t quadrant = 0; quadrant < 4 && id.level < metadata_.tiling.finestLevel; ++quadrant)
        tile.children[quadrant] = recordOf(id.child(quadrant));
    return encodeHeightTile(tile);
}

}  // namespace terray
