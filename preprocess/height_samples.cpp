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

// fmin and fmax take the other argument when one is NaN: NaN only if all four are.
float leastOf(const std::array<float, 4>& cells) {
    return std::fmin(std::fmin(cells[0], cells[1]), std::fmin(cells[2], cells[3]));
}
float greatestOf(const std::array<float, 4>& cells) {
    return std::fmax(std::fmax(cells[0], cells[1]), std::fmax(cells[2], cells[3]));
}

template <class Reduce>
void halve(GridView<const float> fine, GridView<float> coarse, const Reduce& reduce) {
    for (int64_t y = 0; y < coarse.height(); ++y) {
        const std::span<const float> upper = fine.row(2 * y);
        const std::span<const float> lower = fine.row(2 * y + 1);
        const std::span<float> out = coarse.row(y);
        for (size_t x = 0; x < out.size(); ++x)
            out[x] = reduce({upper[2 * x], upper[2 * x + 1], lower[2 * x], lower[2 * x + 1]});
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

/// Greatest distance between a decoded core cell and any source sample beneath it, metres, rounded up.
float measureError(const Grid<uint16_t>& codes, const HeightEncoding& encoding, const HeightViews& core) {
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
    return floatAtLeast(error);
}

}  // namespace

void halveHeights(const HeightViews& fine, HeightSamples& coarse, int64_t firstRow) {
    const GridRect rows = {0, firstRow, coarse.mean.width(), fine.mean.height() / 2};
    TERRAY_CHECK_OP(fine.mean.width(), ==, 2 * rows.width);
    TERRAY_CHECK_OP(fine.mean.height(), ==, 2 * rows.height);
    halve(fine.mean, coarse.mean.view().window(rows), meanOfHeights);
    halve(fine.lowest, coarse.lowest.view().window(rows), leastOf);
    halve(fine.highest, coarse.highest.view().window(rows), greatestOf);
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
    tile.record = measureRecord(tile.codes, tile.encoding, measureError(tile.codes, tile.encoding, input.core));
    tile.children = input.children;
    return tile;
}

}  // namespace terray
