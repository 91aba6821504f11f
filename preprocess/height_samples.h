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
    /// Bound of how far the bilinear surface lies from the finest one over the cell (preprocess/surface_deviation.h).
    /// Empty at the finest level, where it is 0.
    GridView<const float> deviation{};

    [[nodiscard]] HeightViews window(const GridRect& rect) const {
        const bool hasDeviation = deviation.size().count() > 0;
        return {mean.window(rect), lowest.window(rect), highest.window(rect),
                hasDeviation ? deviation.window(rect) : deviation};
    }
};

/// Heights of one level that own their cells.
struct HeightSamples {
    Grid<float> mean;
    Grid<float> lowest;
    Grid<float> highest;
    Grid<float> deviation;

    explicit HeightSamples(GridSize size) : mean(size), lowest(size), highest(size), deviation(size) {}
    [[nodiscard]] HeightViews views() const { return {mean.view(), lowest.view(), highest.view(), deviation.view()}; }
};

/// The lesser or greater of two heights; an x that is NaN is passed over. Compilers make one vector instruction of it.
inline constexpr auto lesser = [](float least, float x) { return x < least ? x : least; };
inline constexpr auto greater = [](float greatest, float x) { return x > greatest ? x : greatest; };

/// Halves a level: each coarse cell is the mean of its 2 x 2 finer ones that have a surface (added in double in row
/// order, rounded to float), with the least and greatest of theirs. No surface only where none of the four has one.
/// Deviations are left as they are.
/// @param fine    both sides even; at the finest level its first three views may be the same one
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

/// Quantises a tile and measures its bounds and its error against the finest source samples: as columns, that of the
/// samples beneath each core cell, exactly; as a bilinear surface, the greatest deviation of a core cell and the
/// greatest rounding of a code that the surface there is made of.
/// @return nothing when its core has no surface
[[nodiscard]] std::optional<HeightTile> makeHeightTile(const HeightTileInput& input);

}  // namespace terray
