#pragma once

#include "common/grid.h"

namespace terray {

/// The finest samples of a ground: what truth is made of. Functions may be called from several threads at once.
class ReferenceHeights {
  public:
    virtual ~ReferenceHeights() = default;
    [[nodiscard]] virtual GridSize size() const = 0;
    /// Metres that no sample in the rectangle, which lies within the grid, is above; -infinity: it has no surface.
    [[nodiscard]] virtual double upperBound(const GridRect& rect) const = 0;
    /// Heights in metres of the rectangle's samples, NaN where there is no surface. Throws Error(dataset) when stored
    /// samples cannot be had.
    [[nodiscard]] virtual Grid<double> read(const GridRect& rect) const = 0;
};

}  // namespace terray
