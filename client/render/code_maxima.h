#pragma once

#include <cstdint>

#include "common/edited_ground.h"
#include "common/grid.h"
#include "common/tiling.h"

namespace terray {

/// How high the bilinear surface of a height tile reaches in its parts: maxima of its codes over squares of 32 x 32
/// core cells and the ring of cells around each, which the surface interpolates (paper 000, section 3.7).
///
/// The records of a dataset bound a tile's own samples only; a bilinear surface leans on those across the border too.
class CodeMaxima {
  public:
    CodeMaxima() = default;
    /// @param codes  516 x 516, with apron. About 50 us.
    explicit CodeMaxima(GridView<const uint16_t> codes);
    /// Of a tile's edited codes, without them: bounds of what the edits make of the maxima of the stored ones, in the
    /// edited encoding. About 100 us more for each edit.
    CodeMaxima(const HeightTile& stored, const EditedTile& edited);

    /// An upper bound of the codes of the bilinear surface over part of the core: without edits exact for squares of 32
    /// cells and more that are aligned to their size, that of the square of 32 around it for smaller ones.
    [[nodiscard]] uint16_t over(double cornerX, double cornerY, double side) const;

  private:
    static constexpr int kSquare = 32;
    static constexpr int kSquares = kTileCore / kSquare;
    Grid<uint16_t> maxima_{{kSquares, kSquares}};
};

}  // namespace terray
