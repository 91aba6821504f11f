#include "tests/stream/fake_dataset.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace terray::test {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// One level of the pyramid as whole grids: mean, and the extremes of the finest samples beneath each cell.
struct Level {
    Grid<float> mean, low, high;
    explicit Level(int64_t side) : mean({side, side}, kNaN), low({side, side}, kNaN), high({side, side}, kNaN) {}
};

Level finestLevel(const HeightFormula& height, GridSize samples, int64_t side) {
    Level level(side);
    for (int64_t y = 0; y < samples.height; ++y) {
        for (int64_t x = 0; x < samples.width; ++x) level.mean.at(x, y) = static_cast<float>(height(x, y));
    }
    level.low = level.high = level.mean;
    return level;
}

Level coarser(const Level& fine) {
    Level level(fine.mean.width() / 2);
    for (int64_t y = 0; y < level.mean.height(); ++y) {
        for (int64_t x = 0; x < level.mean.width(); ++x) {
            double sum = 0;
            int count = 0;
            float low = kNaN, high = kNaN;
            for (int i = 0; i < 4; ++i) {
                const int64_t column = 2 * x + (i & 1), row = 2 * y + (i >> 1);
                const float value = fine.mean.at(column, row);
                if (std::isnan(value)) continue;
                sum += value;
                ++count;
                low = std::fmin(low, fine.low.at(column, row));
                high = std::fmax(high, fine.high.at(column, row));
            }
            if (count == 0) continue;
            level.mean.at(x, y) = static_cast<float>(sum / count);
            level.low.at(x, y) = low;
            level.high.at(x, y) = high;
        }
    }
    return level;
}

float valueOrHole(const Grid<float>& grid, int64_t x, int64_t y) {
    const bool inside = x >= 0 && y >= 0 && x < grid.width() && y < grid.height();
    return inside ? grid.at(x, y) : kNaN;
}

/// The tile with its own record; children are filled in later. No value when its core has no surface.
std::optional<HeightTile> makeTile(const Level& level, const TileId& id, double quantum) {
    const int64_t left = int64_t{id.x} * kTileCore - kHeightApron, top = int64_t{id.y} * kTileCore - kHeightApron;
    float low = kNaN, high = kNaN;
    for (int64_t y = 0; y < kHeightTileSide; ++y) {
        for (int64_t x = 0; x < kHeightTileSide; ++x) {
            low = std::fmin(low, valueOrHole(level.mean, left + x, top + y));
            high = std::fmax(high, valueOrHole(level.mean, left + x, top + y));
        }
    }
    if (std::isnan(low)) return {};
    HeightTile tile{.id = id, .encoding = HeightEncoding::covering(low, high, quantum)};
    tile.codes = Grid<uint16_t>({kHeightTileSide, kHeightTileSide}, kNoSurface);
    double error = 0;
    for (int64_t y = 0; y < kHeightTileSide; ++y) {
        for (int64_t x = 0; x < kHeightTileSide; ++x) {
            const float mean = valueOrHole(level.mean, left + x, top + y);
            if (std::isnan(mean)) continue;
            const uint16_t code = tile.encoding.code(mean);
            tile.codes.at(x, y) = code;
            const bool inCore = std::min(x, y) >= kHeightApron && std::max(x, y) < kHeightApron + kTileCore;
            if (!inCore) continue;
            const double height = tile.encoding.height(code);
            error =
                std::max({error, level.high.at(left + x, top + y) - height, height - level.low.at(left + x, top + y)});
        }
    }
    tile.record = measureRecord(tile.codes, tile.encoding, std::nextafter(static_cast<float>(error), 1e30f));
    if (!tile.record.exists) return {};
    return tile;
}

void addImagery(FakeDataset& dataset, const FakeOptions& options) {
    for (uint32_t level = 0; level <= *options.imageryLevel; ++level) {
        for (uint32_t y = 0; y < 1u << level; ++y) {
            for (uint32_t x = 0; x < 1u << level; ++x) {
                const TileId id{level, x, y};
                if (!options.hasPhoto(id)) continue;
                ImageryTile tile{.id = id, .mips = level == 0 ? kImageryMips : 1};
                tile.blocks =
                    Bytes(level == 0 ? imageryChainBytes() : imageryMipBytes(0), std::byte(level * 16 + x + y));
                for (uint32_t quadrant = 0; quadrant < 4; ++quadrant)
                    tile.childExists[quadrant] = level < *options.imageryLevel && options.hasPhoto(id.child(quadrant));
                dataset.imagery.emplace(id, std::move(tile));
            }
        }
    }
}

DatasetMetadata describe(const FakeDataset& dataset, const FakeOptions& options, uint32_t finest) {
    const HeightRecord& root = dataset.heights.at({}).record;
    DatasetMetadata metadata;
    metadata.tiling = {options.west, options.north, options.spacing, finest};
    metadata.samples = options.samples;
    metadata.imageryLevel = options.imageryLevel;
    metadata.quantum = options.quantum;
    metadata.minHeight = double{root.minHeight} - root.error;
    metadata.maxHeight = double{root.maxHeight} + root.error;
    metadata.heightTiles = dataset.heights.size();
    metadata.imageryTiles = dataset.imagery.size();
    metadata.levelErrors.assign(finest + 1, 0);
    for (const auto& [id, tile] : dataset.heights)
        metadata.levelErrors[id.level] = std::max(metadata.levelErrors[id.level], double{tile.record.error});
    metadata.tool = "tests";
    return metadata;
}

}  // namespace

FakeDataset buildDataset(const HeightFormula& height, const FakeOptions& options) {
    const uint32_t finest = Tiling::levelFor(std::max(options.samples.width, options.samples.height));
    FakeDataset dataset;
    Level level = finestLevel(height, options.samples, int64_t{kTileCore} << finest);
    for (uint32_t l = finest;; --l) {
        for (uint32_t y = 0; y < 1u << l; ++y) {
            for (uint32_t x = 0; x < 1u << l; ++x)
                if (auto tile = makeTile(level, {l, x, y}, options.quantum))
                    dataset.heights.emplace(tile->id, std::move(*tile));
        }
        if (l == 0) break;
        level = coarser(level);
    }
    for (auto& [id, tile] : dataset.heights) {
        for (uint32_t quadrant = 0; quadrant < 4 && id.level < finest; ++quadrant) {
            const auto child = dataset.heights.find(id.child(quadrant));
            if (child != dataset.heights.end()) tile.children[quadrant] = child->second.record;
        }
    }
    if (options.imageryLevel) addImagery(dataset, options);
    dataset.metadata = describe(dataset, options, finest);
    return dataset;
}

HeightFormula hills(double relief) {
    return [relief](int64_t column, int64_t row) {
        const auto x = static_cast<double>(column), y = static_cast<double>(row);
        double height =
            relief * (0.5 + 0.25 * std::sin(x / 150) * std::cos(y / 190) + 0.1 * std::sin((x + 2 * y) / 37));
        height += 0.003 * relief * std::sin(x * 1.7) * std::sin(y * 2.3);
        Random random(static_cast<uint64_t>(column * 1000003 + row));
        if (column == 1023 && row % 97 == 50) height -= 0.7 * relief;
        if (column % 2048 < 900 && random.chance(5e-6)) height += relief * random.uniform(-0.5, 0.3);
        return height;
    };
}

Result<Bytes> FakeSource::read(TileLayer layer, const TileId& id) const {
    if (layer == TileLayer::heights) {
        const auto found = dataset_.heights.find(id);
        if (found == dataset_.heights.end()) return Failure{"no height tile " + toString(id)};
        return encodeHeightTile(found->second);
    }
    const auto found = dataset_.imagery.find(id);
    if (found == dataset_.imagery.end()) return Failure{"no imagery tile " + toString(id)};
    return encodeImageryTile(found->second);
}

TileTree rootsOnly(const FakeDataset& dataset) {
    TileTree tree(dataset.metadata.tiling, dataset.metadata.tiling.finestLevel, dataset.metadata.imageryLevel);
    load(tree, dataset, TileLayer::heights, {});
    if (tree.hasImagery()) load(tree, dataset, TileLayer::imagery, {});
    return tree;
}

void load(TileTree& tree, const FakeDataset& dataset, TileLayer layer, const TileId& id) {
    if (layer == TileLayer::heights) {
        tree.learn(dataset.heights.at(id));
        tree.setHeightsResident(id, true);
    } else {
        tree.learn(dataset.imagery.at(id));
        tree.setImageryResident(id, true);
    }
}

TileTree everything(const FakeDataset& dataset) {
    TileTree tree = rootsOnly(dataset);
    for (const auto& [id, tile] : dataset.heights) load(tree, dataset, TileLayer::heights, id);
    for (const auto& [id, tile] : dataset.imagery) load(tree, dataset, TileLayer::imagery, id);
    return tree;
}

}  // namespace terray::test
