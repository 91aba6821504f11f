#include "client/bench/formula_dataset.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

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

}  // namespace

FormulaDataset::FormulaDataset(const Shape& shape, const Heights& heights)
    : FormulaDataset(shape, [pyramid = pyramidOf(shape.samples, heights, finestLevelOf(shape))](
                                uint32_t up, int64_t column, int64_t row) { return (*pyramid)[up].at(column, row); }) {}

FormulaDataset::FormulaDataset(const Shape& shape, Cells cells) : cells_(std::move(cells)) {
    metadata_.tiling = {shape.west, shape.north, shape.spacing, finestLevelOf(shape)};
    metadata_.samples = shape.samples;
    metadata_.quantum = shape.quantum;
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

HeightTile FormulaDataset::alone(const TileId& id) const {
    const auto forAll = [&](auto use) {
        for (int row = -kHeightApron; row < kTileCore + kHeightApron; ++row)
            for (int column = -kHeightApron; column < kTileCore + kHeightApron; ++column) {
                const FormulaCell of = cell(id, column, row);
                if (!std::isnan(of.mean)) use(column, row, of);
            }
    };
    double low = kNaN, high = kNaN;
    forAll([&](int, int, const FormulaCell& of) {
        low = std::fmin(low, of.mean);
        high = std::fmax(high, of.mean);
    });
    HeightTile tile{.id = id, .codes = Grid<uint16_t>({kHeightTileSide, kHeightTileSide}, kNoSurface)};
    if (std::isnan(low)) return tile;
    tile.encoding = HeightEncoding::covering(low, high, metadata_.quantum);
    double error = 0;
    forAll([&](int column, int row, const FormulaCell& of) {
        const uint16_t code = tile.encoding.code(of.mean);
        tile.codes.at(column + kHeightApron, row + kHeightApron) = code;
        const double height = tile.encoding.height(code);
        const bool inCore = std::min(column, row) >= 0 && std::max(column, row) < kTileCore;
        if (inCore) error = std::max({error, of.high - height, height - of.low});
    });
    tile.record = measureRecord(tile.codes, tile.encoding, floatAtLeast(error));
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
