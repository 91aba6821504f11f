#include "preprocess/height_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "preprocess/raster_source.h"

namespace terray {
namespace {

bool isHeight(float height) {
    return !std::isnan(height);
}

float meanOfHeights(const std::array<float, 4>& cells) {
    double sum = 0;
    int count = 0;
    for (const float height : cells) {
        if (!isHeight(height)) continue;
        sum += static_cast<double>(height);
        ++count;
    }
    return count == 0 ? kNoHeight : static_cast<float>(sum / count);
}

/// Two rows of cells, to be halved.
struct RowPair {
    const float* upper;
    const float* lower;

    RowPair(GridView<const float> fine, int64_t coarseRow)
        : upper(fine.row(2 * coarseRow).data()), lower(fine.row(2 * coarseRow + 1).data()) {}
};

/// In vector code where all four have a surface, which is almost everywhere.
void halveMeans(GridView<const float> fine, GridView<float> coarse) {
    for (int64_t y = 0; y < coarse.height(); ++y) {
        const auto [upper, lower] = RowPair(fine, y);
        const std::span<float> out = coarse.row(y);
        const auto wide = [](float height) { return static_cast<double>(height); };
        for (size_t x = 0; x < out.size(); ++x)
            out[x] = static_cast<float>(
                (wide(upper[2 * x]) + wide(upper[2 * x + 1]) + wide(lower[2 * x]) + wide(lower[2 * x + 1])) * 0.25);
        for (size_t x = 0; x < out.size(); ++x)
            if (!isHeight(out[x]))
                out[x] = meanOfHeights({upper[2 * x], upper[2 * x + 1], lower[2 * x], lower[2 * x + 1]});
    }
}

/// @param better  the bound of one that stands and one that may be NaN, which it passes over
template <class Better>
void halveBounds(GridView<const float> fine, GridView<float> coarse, const Better& better) {
    const auto boundOf = [&](float a, float b) { return isHeight(a) ? better(a, b) : b; };
    for (int64_t y = 0; y < coarse.height(); ++y) {
        const auto [upper, lower] = RowPair(fine, y);
        const std::span<float> out = coarse.row(y);
        for (size_t x = 0; x < out.size(); ++x)
            out[x] = boundOf(boundOf(upper[2 * x], upper[2 * x + 1]), boundOf(lower[2 * x], lower[2 * x + 1]));
    }
}

struct Range {
    float least = std::numeric_limits<float>::infinity();
    float greatest = -std::numeric_limits<float>::infinity();

    [[nodiscard]] bool empty() const { return least > greatest; }
    void add(std::span<const float> heights) {
        for (const float height : heights) {
            if (!isHeight(height)) continue;
            least = std::min(least, height);
            greatest = std::max(greatest, height);
        }
    }
};

Range rangeOf(GridView<const float> heights) {
    Range range;
    for (int64_t y = 0; y < heights.height(); ++y) range.add(heights.row(y));
    return range;
}

bool anyHeight(GridView<const float> heights) {
    for (int64_t y = 0; y < heights.height(); ++y)
        if (std::ranges::any_of(heights.row(y), isHeight)) return true;
    return false;
}

Grid<uint16_t> quantised(GridView<const float> heights, const HeightEncoding& encoding) {
    Grid<uint16_t> codes(heights.size(), kNoSurface);
    for (int64_t y = 0; y < heights.height(); ++y) {
        const std::span<const float> from = heights.row(y);
        const std::span<uint16_t> to = codes.view().row(y);
        for (size_t x = 0; x < from.size(); ++x)
            if (isHeight(from[x])) to[x] = encoding.code(static_cast<double>(from[x]));
    }
    return codes;
}

/// Greatest distance between a decoded core cell and any source sample beneath it, metres.
double measureColumns(const Grid<uint16_t>& codes, const HeightEncoding& encoding, const HeightViews& core) {
    double error = 0;
    const GridView<const uint16_t> coreCodes = codes.view().window({kHeightApron, kHeightApron, kTileCore, kTileCore});
    for (int64_t y = 0; y < kTileCore; ++y) {
        const std::span<const uint16_t> row = coreCodes.row(y);
        const std::span<const float> lowest = core.lowest.row(y);
        const std::span<const float> highest = core.highest.row(y);
        for (size_t x = 0; x < row.size(); ++x) {
            if (row[x] == kNoSurface) continue;
            const double height = encoding.height(row[x]);
            error =
                std::max({error, height - static_cast<double>(lowest[x]), static_cast<double>(highest[x]) - height});
        }
    }
    return error;
}

/// Greatest distance between a cell and its code, over the core and the cells around it that its bilinear surface is
/// made of, metres.
double measureRounding(const Grid<uint16_t>& codes, const HeightEncoding& encoding, GridView<const float> mean) {
    const GridRect cells = {kHeightApron - 1, kHeightApron - 1, kTileCore + 2, kTileCore + 2};
    const GridView<const uint16_t> usedCodes = codes.view().window(cells);
    const GridView<const float> heights = mean.window(cells);
    double rounding = 0;
    for (int64_t y = 0; y < usedCodes.height(); ++y) {
        const std::span<const uint16_t> row = usedCodes.row(y);
        const std::span<const float> height = heights.row(y);
        for (size_t x = 0; x < row.size(); ++x)
            if (row[x] != kNoSurface)
                rounding = std::max(rounding, std::abs(encoding.height(row[x]) - static_cast<double>(height[x])));
    }
    return rounding;
}

/// See HeightTile::record. Metres, rounded up.
float measureError(const HeightTile& tile, const HeightTileInput& input) {
    const double rounding = measureRounding(tile.codes, tile.encoding, input.mean);
    // A finest tile is off by its codes alone.
    if (input.core.deviation.size().count() == 0) return floatAtLeast(rounding);
    const Range deviations = rangeOf(input.core.deviation);
    return floatAtLeast(std::max(measureColumns(tile.codes, tile.encoding, input.core),
                                 static_cast<double>(deviations.greatest) + rounding));
}

}  // namespace

void halveHeights(const HeightViews& fine, HeightSamples& coarse, int64_t firstRow) {
    const GridRect rows = {0, firstRow, coarse.mean.width(), fine.mean.height() / 2};
    TERRAY_CHECK_OP(fine.mean.width(), ==, 2 * rows.width);
    TERRAY_CHECK_OP(fine.mean.height(), ==, 2 * rows.height);
    halveMeans(fine.mean, coarse.mean.view().window(rows));
    halveBounds(fine.lowest, coarse.lowest.view().window(rows), lesser);
    halveBounds(fine.highest, coarse.highest.view().window(rows), greater);
}

std::optional<HeightTile> makeHeightTile(const HeightTileInput& input) {
    TERRAY_CHECK(input.mean.size() == GridSize(kHeightTileSide, kHeightTileSide));
    TERRAY_CHECK(input.core.mean.size() == GridSize(kTileCore, kTileCore));
    if (!anyHeight(input.core.mean)) return {};

    // The apron's heights take part in the range: the renderer marches over them too.
    const Range range = rangeOf(input.mean);
    HeightTile tile;
    tile.id = input.id;
    tile.encoding =
        HeightEncoding::covering(static_cast<double>(range.least), static_cast<double>(range.greatest), input.quantum);
    tile.codes = quantised(input.mean, tile.encoding);
    tile.record = measureRecord(tile.codes, tile.encoding, measureError(tile, input));
    tile.children = input.children;
    return tile;
}

}  // namespace terray
