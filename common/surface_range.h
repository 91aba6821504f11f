#pragma once

#include <algorithm>

namespace terray {

/// Bounds of heights over some of a level's cells, metres. Real: float or double.
template <class Real>
struct CellHeights {
    Real leastMean;  ///< of the level's own heights
    Real greatestMean;
    Real lowest;  ///< of the finest samples beneath
    Real highest;
};

/// How far a level's bilinear surface may lie from the finest one, straight up or down, anywhere over a cell, where no
/// more is known than these bounds.
///
/// A bilinear surface over the cell of one of its samples is an average of that sample, which weighs at least a quarter
/// (each of the two distances from the sample is at most half of that to the next one, and the share of a missing
/// sample goes to those that exist), and of up to three more samples around it. So the level's surface lies above
/// mean / 4 + 3/4 leastMean around; and the finest one, whose cells are smaller, above lowest / 4 + 3/4 lowest around;
/// likewise from above.
///
/// On flat, cliff or noise it is near the truth, on a slope three times the steps between cells.
/// @param cell    of the cell alone  @param around  of it and its eight neighbours
template <class Real>
[[nodiscard]] inline Real surfaceRangeBound(const CellHeights<Real>& cell, const CellHeights<Real>& around) {
    constexpr auto kOwn = static_cast<Real>(0.25), kOthers = static_cast<Real>(0.75);
    const Real below = kOwn * (cell.greatestMean - cell.lowest) + kOthers * (around.greatestMean - around.lowest);
    const Real above = kOwn * (cell.highest - cell.leastMean) + kOthers * (around.highest - around.leastMean);
    return std::max(below, above);
}

}  // namespace terray
