#pragma once

#include <span>

#include "common/grid.h"
#include "common/view.h"
#include "tests/bench/embree_rates/ground.h"

namespace terray {

/// Least to greatest, of absolute values.
struct Errors {
    double median = 0;
    double percentile99 = 0;
    double most = 0;
};

/// Two depth pictures of one view: `march` of the bilinear surface, `mesh` of two triangles to a cell.
struct Agreement {
    int64_t pixels = 0;
    int64_t bothHit = 0;
    int64_t onlyMarchHits = 0;
    int64_t onlyMeshHits = 0;
    Errors depth;  ///< metres, where both hit: difference of view depth
    /// Metres: height of the hit above or below the bilinear surface at its place.
    Errors marchResidual;
    Errors meshResidual;
    /// Mesh hits off the bilinear surface by more than two triangles can be, a quarter of the cell's twist, and 1 cm of
    /// rounding: those that the difference of the surfaces does not explain.
    int64_t unexplained = 0;
};
[[nodiscard]] Agreement compareDepths(const Ground& ground, const View& view, GridView<const float> march,
                                      GridView<const float> mesh);

/// A depth picture against brute force in double (tests/bench/packet_march/brute_force.h) on about `count` of its
/// pixels.
struct Truth {
    int64_t rays = 0;
    int64_t disagreements = 0;  ///< in hit or miss
    Errors depth;               ///< metres, where both hit
};
[[nodiscard]] Truth compareWithTruth(const Ground& ground, const View& view, GridView<const float> depths,
                                     int64_t count);

}  // namespace terray
