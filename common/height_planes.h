#pragma once

#include "common/bytes.h"
#include "common/grid.h"

namespace terray {

// How the codes of a height tile become bytes that compress well, and back (FORMAT.md, "Body").
//
// Two planes, the low bytes then the high bytes of zigzagged prediction residuals, row by row. When the tile has holes,
// a plane of bits goes first (cell n, counted row by row, is bit n % 8 of byte n / 8; 1 is a surface), and predictions
// run on as if each hole continued its western neighbour.

/// Bytes of the planes of a tile of this size.
[[nodiscard]] size_t heightPlaneBytes(GridSize size, bool hasHoles);

/// The planes of some codes; hasHoles must say whether any of them is 0.
[[nodiscard]] Bytes planesFromCodes(const Grid<uint16_t>& codes, bool hasHoles);

/// The inverse, row by row in loops that vectorise. planes must be heightPlaneBytes(size, hasHoles); any content is
/// taken.
[[nodiscard]] Grid<uint16_t> codesFromPlanes(ByteView planes, bool hasHoles, GridSize size);

}  // namespace terray
