#include "preprocess/colour_samples.h"

#include <algorithm>

#include "common/imagery_tile.h"
#include "common/srgb.h"

namespace terray {
namespace {

constexpr Rgba kNoPhoto = {kNeutralGround[0], kNeutralGround[1], kNeutralGround[2], 255};

float meanOf(float a, float b, float c, float d) {
    return ((a + b) + (c + d)) * 0.25f;
}

}  // namespace

void halveColours(const ColourViews& fine, ColourSamples& coarse, int64_t firstRow) {
    TERRAY_CHECK_OP(fine.size().width, ==, 2 * coarse.planes[0].width());
    for (size_t plane = 0; plane < 4; ++plane) {
        for (int64_t y = 0; y < fine.size().height / 2; ++y) {
            const std::span<const float> upper = fine.planes[plane].row(2 * y);
            const std::span<const float> lower = fine.planes[plane].row(2 * y + 1);
            const std::span<float> out = coarse.planes[plane].view().row(firstRow + y);
            for (size_t x = 0; x < out.size(); ++x)
                out[x] = meanOf(upper[2 * x], upper[2 * x + 1], lower[2 * x], lower[2 * x + 1]);
        }
    }
}

void halveColours(GridView<const Rgba> fine, ColourSamples& coarse) {
    TERRAY_CHECK_OP(fine.width(), ==, 2 * coarse.planes[0].width());
    const auto weighted = [](const Rgba& cell, size_t plane) {
        const float coverage = static_cast<float>(cell[3]) / 255;
        return plane == 3 ? coverage : linearFromSrgb(cell[plane]) * coverage;
    };
    for (int64_t y = 0; y < fine.height() / 2; ++y) {
        const std::span<const Rgba> upper = fine.row(2 * y);
        const std::span<const Rgba> lower = fine.row(2 * y + 1);
        for (size_t plane = 0; plane < 4; ++plane) {
            const std::span<float> out = coarse.planes[plane].view().row(y);
            for (size_t x = 0; x < out.size(); ++x)
                out[x] = meanOf(weighted(upper[2 * x], plane), weighted(upper[2 * x + 1], plane),
                                weighted(lower[2 * x], plane), weighted(lower[2 * x + 1], plane));
        }
    }
}

bool anyPhoto(GridView<const Rgba> cells) {
    for (int64_t y = 0; y < cells.height(); ++y)
        if (std::ranges::any_of(cells.row(y), [](const Rgba& cell) { return cell[3] > 0; })) return true;
    return false;
}

bool anyPhoto(const ColourViews& cells) {
    for (int64_t y = 0; y < cells.size().height; ++y)
        if (std::ranges::any_of(cells.planes[3].row(y), [](float coverage) { return coverage > 0; })) return true;
    return false;
}

Grid<Rgba> shownColours(GridView<const Rgba> cells) {
    Grid<Rgba> shown(cells.size(), kNoPhoto);
    for (int64_t y = 0; y < cells.height(); ++y) {
        const std::span<const Rgba> from = cells.row(y);
        const std::span<Rgba> to = shown.view().row(y);
        for (size_t x = 0; x < from.size(); ++x)
            if (from[x][3] > 0) to[x] = {from[x][0], from[x][1], from[x][2], 255};
    }
    return shown;
}

Grid<Rgba> shownColours(const ColourViews& cells) {
    Grid<Rgba> shown(cells.size(), kNoPhoto);
    for (int64_t y = 0; y < cells.size().height; ++y) {
        const std::span<const float> coverage = cells.planes[3].row(y);
        const std::span<Rgba> to = shown.view().row(y);
        for (size_t plane = 0; plane < 3; ++plane) {
            const std::span<const float> light = cells.planes[plane].row(y);
            for (size_t x = 0; x < coverage.size(); ++x)
                if (coverage[x] > 0) to[x][plane] = srgbFromLinear(light[x] / coverage[x]);
        }
    }
    return shown;
}

}  // namespace terray
