#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "common/check.h"

namespace terray {

/// The smallest value that `percent` of all do not exceed (nearest rank).
/// @param sorted  ascending, not empty  @param percent  0 .. 100
template <class Number>
[[nodiscard]] Number percentile(std::span<const Number> sorted, double percent) {
    TERRAY_CHECK_OP(sorted.size(), >, 0u);
    const double rank = std::ceil(percent / 100 * static_cast<double>(sorted.size()));
    return sorted[static_cast<size_t>(std::max(rank, 1.0)) - 1];
}

}  // namespace terray
