#pragma once

#include <array>
#include <optional>

#include "common/grid.h"
#include "common/height_tile.h"

namespace terray {

/// Read-only look at the heights of one level: metres, NaN where there is no surface.
struct HeightViews {
    GridView<const float> mean;
    GridView<const float> lowest;   ///< least of the finest source samples beneath the cell
    GridView<const float> highest;  ///< greatest of them

    [[nodiscard]] HeightViews window(const GridRect& rect) const {
        return {mean.window(rect), lowest.window(rect), highest.window(rect)};
    }
};

/// Heights of one level that own their cells.
struct HeightSamples {
    Grid<float> mean;
    Grid<float> lowest;
    Grid<float> highest;

    explicit HeightSamples(GridSize size) : mean(size), lowest(size), highest(size) {}
    [[nodiscard]] HeightViews views() const { return {mean.view(), lowest.view(), highest.view()}; }
};

/// Halves a level: each coarse cell is the mean of its 2 x 2 finer ones that have a surface (added in double in row
/// order, rounded to float), with the least and greatest of theirs. No surface only where none of the four has one.
/// @param fine    both sides even; at the finest level all three views may be the same one
/// @param coarse  receives rows firstRow .. firstRow + fine.height / 2 - 1, so that a level can be halved in bands
void halveHeights(const HeightViews& fine, HeightSamples& coarse, int64_t firstRow = 0);

/// What a height tile is made of.
struct HeightTileInput {
    TileId id;
    GridView<const float> mean;  ///< kHeightTileSide squared, apron included
    HeightViews core;            ///< kTileCore squared
    double quantum = 0.01;       ///< metres
    std::array<HeightRecord, 4> children{};
};

/// Quantises a tile and measures its bounds and its error against the finest source samples.
/// @return nothing when its core has no surface
[[nodiscard]] std::optional<HeightTile> makeHeightTile(const HeightTileInput& input);

}  // namespace terray
