#pragma once

#include "common/grid.h"
#include "preprocess/height_samples.h"

namespace terray {

// How far the bilinear surface of a coarser level lies from the finest one: a bound for each cell, over all of the
// ground of the cell, not at samples only.
//
// The surfaces. Between four sample centres lies a bilinear patch, each sample owning the quarter at its corner. A
// sample without surface leaves its quarter open, and the patch's missing corner stands at the mean of those that
// exist.
//
// One level to the next. A coarse cell is 2 x 2 fine ones, so along each axis coarse patches begin and end at the
// middle of a cell, fine ones at 1/4 and 3/4. Between neighbouring lines at 0, 1/4, 1/2, 3/4, 1 both surfaces are
// bilinear and so is their difference: its extremes lie where these lines cross, 25 points a cell. (The lines at 0 and
// 1 only part cells from one another.)
//
// Over all levels. Let d(c) bound the distance of the fine level from the finest over the fine cell c; 0 where the fine
// level is the finest. By the triangle inequality, cell by cell,
//     d(C) = max over the four c of C ( greatest |difference| over c + d(c) ),
// so errors of different places are never added. Where one cliff accounts for all of the sum, it grows by a quarter of
// the cliff with each level, and the truth does not beyond half of it; so d(C) is at most surfaceRangeBound() too.
//
// Rounding: differences of floats are taken first, so each of less than 32 roundings on the way is one of a number
// within the range of the heights around: 32 * 2^-24 of it are added.

/// Levels that boundDeviations() compares.
struct DeviationInput {
    HeightViews coarse;                   ///< of w x h cells and one more on each side; deviation is not read
    GridView<const float> fine;           ///< heights of the cells beneath these, 2 (w + 2) x 2 (h + 2)
    GridView<const float> fineDeviation;  ///< d of 2 w x 2 h cells; empty: 0 everywhere
};

/// Bounds the deviation of w x h cells; NaN where they have no surface. The result for a cell does not depend on what
/// else is asked for. Cost: 9 ns a cell of a 2020s server's core, a hundred times that near holes.
void boundDeviations(const DeviationInput& input, GridView<float> deviation);

}  // namespace terray
