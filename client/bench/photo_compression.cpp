#include "client/bench/photo_compression.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "client/bench/measured_frame.h"
#include "common/bc1_decode.h"
#include "common/error.h"
#include "common/reference/picture_error.h"

namespace terray {
namespace {

ImageryTile tileAt(const TileSource& source, const TileId& id) {
    const Result<Bytes> payload = source.read(TileLayer::imagery, id);
    Result<ImageryTile> tile = payload ? decodeImageryTile(*payload, id) : Result<ImageryTile>(payload.failure());
    if (!tile)
        throw Error(ExitCode::dataset, "cannot read imagery tile " + toString(id) + ": " + tile.failure().message +
                                           " (terray-preprocess verify lists all damaged tiles)");
    return std::move(*tile);
}

/// The tile's own square, without the gutter.
Grid<Rgba> coreOf(const ImageryTile& tile) {
    const Grid<Rgba> all = decodeBc1(tile.mip(0), {kImageryTileSide, kImageryTileSide});
    Grid<Rgba> core({kTileCore, kTileCore});
    for (int64_t y = 0; y < kTileCore; ++y)
        for (int64_t x = 0; x < kTileCore; ++x) core.at(x, y) = all.at(x + kImageryGutter, y + kImageryGutter);
    return core;
}

/// The tiles of a level of which all four children exist, in their order.
void collect(std::vector<TileId>& found, const TileSource& source, const TileId& id, uint32_t level) {
    const ImageryTile tile = tileAt(source, id);
    if (id.level == level) {
        const bool whole = std::all_of(tile.childExists.begin(), tile.childExists.end(), [](bool is) { return is; });
        if (whole) found.push_back(id);
        return;
    }
    for (uint32_t quadrant = 0; quadrant < 4; ++quadrant)
        if (tile.childExists[quadrant]) collect(found, source, id.child(quadrant), level);
}

/// What the tile was compressed from, as its children tell it.
Grid<Rgba> meansOfChildren(const TileSource& source, const TileId& id) {
    Grid<Rgba> means({kTileCore, kTileCore});
    for (uint32_t quadrant = 0; quadrant < 4; ++quadrant) {
        const Grid<Rgba> fine = coreOf(tileAt(source, id.child(quadrant)));
        const Grid<Rgba> half = averaged(fine.view(), 2);
        const int64_t left = (quadrant & 1) * half.width();
        const int64_t top = (quadrant >> 1) * half.height();
        for (int64_t y = 0; y < half.height(); ++y)
            for (int64_t x = 0; x < half.width(); ++x) means.at(left + x, top + y) = half.at(x, y);
    }
    return means;
}

}  // namespace

std::optional<PhotoCompression> measurePhotoCompression(const TileSource& source) {
    constexpr size_t kMostTiles = 24;
    const std::optional<uint32_t> finest = source.metadata().imageryLevel;
    if (!finest || *finest == 0) return std::nullopt;
    std::vector<TileId> tiles;
    collect(tiles, source, {}, *finest - 1);
    const size_t count = std::min(tiles.size(), kMostTiles);
    double flip = 0;
    double squares = 0;
    for (size_t n = 0; n < count; ++n) {
        const TileId& id = tiles[n * tiles.size() / count];
        const Grid<Rgba> before = meansOfChildren(source, id);
        const Grid<Rgba> after = coreOf(tileAt(source, id));
        const Grid<float> map = flipOf(before.view(), after.view());
        flip += spreadOf(map.cells()).mean;
        const std::optional<double> ratio = psnr(before.view(), after.view());
        squares += ratio ? std::pow(10, -*ratio / 10) : 0;
    }
    if (squares == 0) return std::nullopt;
    const auto tilesMeasured = static_cast<double>(count);
    return PhotoCompression{.flip = flip / tilesMeasured, .psnr = -10 * std::log10(squares / tilesMeasured)};
}

}  // namespace terray
