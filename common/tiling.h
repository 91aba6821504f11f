#pragma once

#include <cmath>
#include <cstdint>

#include "common/grid.h"
#include "common/tile_id.h"

namespace terray {

/// Samples along the side of a tile's own square, heights and imagery alike.
inline constexpr int kTileCore = 512;
/// Samples that a height tile repeats from its neighbours on each side, for gradients and bilinear patches without
/// seams.
inline constexpr int kHeightApron = 2;
inline constexpr int kHeightTileSide = kTileCore + 2 * kHeightApron;
/// Texels that an imagery tile repeats on each side. Mip m of a tile on the GPU has a gutter of 32 >> m texels; 32, 16,
/// 8 and 4 are multiples of BC1's block side, so a mip chain is gathered from ancestors by copying whole blocks.
inline constexpr int kImageryGutter = 32;
inline constexpr int kImageryTileSide = kTileCore + 2 * kImageryGutter;
/// Mip levels of an imagery tile on the GPU: sides 576, 288, 144, 72. With 16x anisotropy they cover footprints of
/// 16 * 2^3 = 128 texels.
inline constexpr int kImageryMips = 4;

/// An axis-parallel rectangle of the ground in metres of the dataset's coordinate system, y to the north.
struct GroundRect {
    double west = 0;
    double south = 0;
    double east = 0;
    double north = 0;

    bool operator==(const GroundRect&) const = default;
};

/// How the quadtree lies on the ground: the only place that turns tiles and samples into coordinates.
///
/// The root square's upper-left corner is the DEM's, its side is 512 * 2^finestLevel samples of the finest spacing.
/// Samples are cell-centred: sample (i, j) of a level covers the square [i, i + 1) x [j, j + 1) of that level's
/// spacing, j to the south. Levels of imagery use the same squares, so an imagery level may be deeper than finestLevel.
struct Tiling {
    double west = 0;           ///< x of the root square's left edge, metres
    double north = 0;          ///< y of the root square's upper edge, metres
    double finestSpacing = 1;  ///< metres between samples of the finest height level, > 0
    uint32_t finestLevel = 0;  ///< level of the finest heights

    bool operator==(const Tiling&) const = default;

    /// Metres between samples of a level, exact for powers of two times finestSpacing.
    [[nodiscard]] double spacing(uint32_t level) const {
        return std::ldexp(finestSpacing, static_cast<int>(finestLevel) - static_cast<int>(level));
    }
    /// Side of a tile of this level, metres.
    [[nodiscard]] double tileSide(uint32_t level) const { return kTileCore * spacing(level); }
    /// The square of ground under a tile (core, without apron).
    [[nodiscard]] GroundRect bounds(const TileId& id) const {
        const double side = tileSide(id.level);
        const double left = west + id.x * side;
        const double top = north - id.y * side;
        return {left, top - side, left + side, top};
    }
    /// Samples of a level that a tile's core holds, as a rectangle of that level's global sample grid.
    [[nodiscard]] static GridRect coreSamples(const TileId& id) {
        return {int64_t{id.x} * kTileCore, int64_t{id.y} * kTileCore, kTileCore, kTileCore};
    }
    /// The level whose 512 * 2^level samples are the first to hold `samples` of them along a side.
    [[nodiscard]] static uint32_t levelFor(int64_t samples) {
        uint32_t level = 0;
        while ((int64_t{kTileCore} << level) < samples) ++level;
        return level;
    }
};

}  // namespace terray
