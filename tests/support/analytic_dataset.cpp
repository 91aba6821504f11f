#include "tests/support/analytic_dataset.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/json.h"

namespace terray {
namespace {

uint64_t tilesTo(uint32_t finestLevel) {
    uint64_t tiles = 0;
    for (uint32_t level = 0; level <= finestLevel; ++level) tiles += uint64_t{1} << (2 * level);
    return tiles;
}

/// A BC1 block of one colour, 5-6-5 bits.
void writeBlock(ByteWriter& out, uint16_t colour) {
    out.write(colour);
    out.write(colour);
    out.write(uint32_t{0});
}

}  // namespace

double AnalyticDataset::heightAt(double x, double y) {
    return 1000 + 300 * std::sin(x / 900) * std::cos(y / 700) + 20 * std::sin(x / 97) * std::sin(y / 83);
}

AnalyticDataset::AnalyticDataset(const Options& options) {
    metadata_.tiling = {
        .west = 400000, .north = 5200000, .finestSpacing = options.spacing, .finestLevel = options.finestLevel};
    metadata_.samples = {int64_t{kTileCore} << options.finestLevel, int64_t{kTileCore} << options.finestLevel};
    metadata_.quantum = 0.05;
    metadata_.minHeight = 600;
    metadata_.maxHeight = 1400;
    metadata_.heightTiles = tilesTo(options.finestLevel);
    metadata_.imageryLevel = options.imageryLevel;
    if (options.imageryLevel) {
        metadata_.imageryTiles = tilesTo(*options.imageryLevel);
        metadata_.imageryBounds = metadata_.groundBounds();
    }
    for (uint32_t level = 0; level <= options.finestLevel; ++level)
        metadata_.levelErrors.push_back(kSteepest * metadata_.tiling.spacing(level));
    metadata_.tool = "tests";
    encoding_ = HeightEncoding::covering(metadata_.minHeight, metadata_.maxHeight, metadata_.quantum);
}

Grid<uint16_t> AnalyticDataset::codesOf(const TileId& id) const {
    const Tiling& tiling = metadata_.tiling;
    const GroundRect bounds = tiling.bounds(id);
    const GroundRect root = tiling.bounds({});
    const double spacing = tiling.spacing(id.level);
    Grid<uint16_t> codes({kHeightTileSide, kHeightTileSide}, kNoSurface);
    for (int row = 0; row < kHeightTileSide; ++row)
        for (int column = 0; column < kHeightTileSide; ++column) {
            const double x = bounds.west + (column - kHeightApron + 0.5) * spacing;
            const double y = bounds.north - (row - kHeightApron + 0.5) * spacing;
            if (x > root.west && x < root.east && y > root.south && y < root.north)
                codes.at(column, row) = encoding_.code(heightAt(x, y));
        }
    return codes;
}

HeightRecord AnalyticDataset::recordOf(const TileId& id) const {
    const auto found = records_.find(id);
    if (found != records_.end()) return found->second;
    // From the centre of a cell to any sample beneath it is at most half a diagonal, plus half a code.
    const double error =
        kSteepest * metadata_.tiling.spacing(id.level) * std::sqrt(0.5) + encoding_.metresPerCode() / 2;
    return records_[id] = measureRecord(codesOf(id), encoding_, floatAtLeast(error));
}

HeightTile AnalyticDataset::heightTile(const TileId& id) const {
    HeightTile tile{.id = id, .encoding = encoding_, .record = recordOf(id), .codes = codesOf(id)};
    if (id.level < metadata_.tiling.finestLevel)
        for (uint32_t quadrant = 0; quadrant < 4; ++quadrant) tile.children[quadrant] = recordOf(id.child(quadrant));
    return tile;
}

ImageryTile AnalyticDataset::imageryTile(const TileId& id) const {
    constexpr double kFieldMetres = 256;
    ImageryTile tile{.id = id, .mips = id.level == 0 ? kImageryMips : 1};
    tile.childExists.fill(id.level < *metadata_.imageryLevel);
    const GroundRect bounds = metadata_.tiling.bounds(id);
    ByteWriter blocks;
    for (int mip = 0; mip < tile.mips; ++mip) {
        const double texel = metadata_.tiling.spacing(id.level) * (1 << mip);
        const int gutter = kImageryGutter >> mip;
        const int side = imageryMipSide(mip) / 4;
        for (int row = 0; row < side; ++row)
            for (int column = 0; column < side; ++column) {
                const double x = bounds.west + (4 * column + 2 - gutter) * texel;
                const double y = bounds.north - (4 * row + 2 - gutter) * texel;
                const auto field = std::llround(std::floor(x / kFieldMetres) + std::floor(y / kFieldMetres));
                writeBlock(blocks, field % 2 == 0 ? 0xc000 : 0x0400);
            }
    }
    tile.blocks = blocks.release();
    return tile;
}

Result<Bytes> AnalyticDataset::read(TileLayer layer, const TileId& id) const {
    ++reads_;
    const std::lock_guard lock(mutex_);
    const std::pair key{layer, id};
    if (lost_.contains(key)) return Failure{"tile " + toString(id) + " was lost by the test"};
    const auto found = payloads_.find(key);
    if (found != payloads_.end()) return found->second;
    return payloads_[key] =
               layer == TileLayer::heights ? encodeHeightTile(heightTile(id)) : encodeImageryTile(imageryTile(id));
}

void AnalyticDataset::writeArchive(const std::filesystem::path& path, TileLayer layer, uint32_t finestLevel) const {
    PmtilesWriter writer(path);
    for (uint64_t hilbert = 0; hilbert < tilesTo(finestLevel); ++hilbert) {
        const TileId id = tileFromHilbert(hilbert).value();
        writer.add(id, read(layer, id).value());
    }
    writer.finish(toJson(metadata_).dump(), {.minZoom = 0, .maxZoom = static_cast<uint8_t>(finestLevel)});
}

void AnalyticDataset::write(const std::filesystem::path& directory) const {
    writeArchive(directory / kHeightsFile, TileLayer::heights, metadata_.tiling.finestLevel);
    if (metadata_.imageryLevel) writeArchive(directory / kImageryFile, TileLayer::imagery, *metadata_.imageryLevel);
}

}  // namespace terray
