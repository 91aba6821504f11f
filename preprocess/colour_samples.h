#pragma once

#include <array>

#include "common/grid.h"
#include "preprocess/raster_source.h"

namespace terray {

/// A photo in linear light: red, green and blue, each multiplied by coverage, and coverage (0..1). Floats, so that a
/// cell covered in part weighs right however many levels up, and so that the dark end keeps its 8-bit steps (16-bit
/// linear light has only 20 steps in the darkest one).
struct ColourViews {
    std::array<GridView<const float>, 4> planes;

    [[nodiscard]] GridSize size() const { return planes[0].size(); }
    [[nodiscard]] ColourViews window(const GridRect& rect) const {
        return {{planes[0].window(rect), planes[1].window(rect), planes[2].window(rect), planes[3].window(rect)}};
    }
};

struct ColourSamples {
    std::array<Grid<float>, 4> planes;

    explicit ColourSamples(GridSize size)
        : planes{Grid<float>(size), Grid<float>(size), Grid<float>(size), Grid<float>(size)} {}
    [[nodiscard]] ColourViews views() const {
        return {{planes[0].view(), planes[1].view(), planes[2].view(), planes[3].view()}};
    }
};

/// Halves an image: the mean of 2 x 2 cells in linear light, weighted by coverage. Sides of `fine` are even.
/// @param firstRow  row of `coarse` that receives the first result, so that a level can be halved in bands
void halveColours(const ColourViews& fine, ColourSamples& coarse, int64_t firstRow = 0);
void halveColours(GridView<const Rgba> fine, ColourSamples& coarse);

/// Whether any cell has photo.
[[nodiscard]] bool anyPhoto(GridView<const Rgba> cells);
[[nodiscard]] bool anyPhoto(const ColourViews& cells);

/// The image as it is shown: sRGB, opaque, kNeutralGround where there is no photo at all.
[[nodiscard]] Grid<Rgba> shownColours(GridView<const Rgba> cells);
[[nodiscard]] Grid<Rgba> shownColours(const ColourViews& cells);

}  // namespace terray
