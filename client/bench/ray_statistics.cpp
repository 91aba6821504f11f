#include "client/bench/ray_statistics.h"

#include <algorithm>
#include <vector>

#include "client/render/frame_targets.h"

namespace terray {

RayStatistics measureRays(const Grid<uint32_t>& steps, const Grid<uint32_t>& nodes) {
    TERRAY_CHECK(steps.size() == nodes.size());
    RayStatistics result;
    result.rays = steps.cells().size();
    std::vector<uint32_t> counts;  // of the rays that entered a box
    counts.reserve(result.rays);
    uint64_t sum = 0;
    for (const uint32_t cell : steps.cells()) {
        if ((cell & kStepCountMask) != 0) counts.push_back(cell & kStepCountMask);
        sum += cell & kStepCountMask;
        if ((cell & kOutOfStepsBit) != 0) ++result.outOfSteps;
    }
    for (const uint32_t node : nodes.cells())
        if (node != 0) ++result.hit;
    result.sky = result.rays - result.hit;
    result.marched = counts.size();
    if (counts.empty()) return result;

    // The 99th percentile by nearest rank: the least count that 99 % of the rays do not exceed.
    const size_t rank = (99 * counts.size() + 99) / 100 - 1;
    std::ranges::nth_element(counts, counts.begin() + static_cast<ptrdiff_t>(rank));
    result.stepsP99 = counts[rank];
    result.stepsMax = *std::ranges::max_element(counts);
    result.stepsMean = static_cast<double>(sum) / static_cast<double>(counts.size());
    return result;
}

}  // namespace terray
