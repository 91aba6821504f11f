#pragma once

#include <cstdint>

#include "common/grid.h"

namespace terray {

/// What the rays of one picture did; one ray a pixel.
struct RayStatistics {
    uint64_t rays = 0;
    uint64_t marched = 0;     ///< took at least one step; mean and percentile are over these
    uint64_t hit = 0;         ///< ended on ground
    uint64_t sky = 0;         ///< all others
    uint64_t outOfSteps = 0;  ///< gave up: a defect unless 0
    double stepsMean = 0;
    uint32_t stepsP99 = 0;  ///< the smallest count that 99 % of the marched rays do not exceed
    uint32_t stepsMax = 0;

    bool operator==(const RayStatistics&) const = default;
};

/// @param steps  as FrameTargets::readSteps  @param nodes  as FrameTargets::readNodes, of the same size
[[nodiscard]] RayStatistics measureRays(const Grid<uint32_t>& steps, const Grid<uint32_t>& nodes);

}  // namespace terray
