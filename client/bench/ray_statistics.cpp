#include "client/bench/ray_statistics.h"

#include <algorithm>
#include <vector>

namespace terray {

RayStatistics measureRays(const Grid<uint32_t>& steps, const Grid<uint32_t>& nodes) {
    constexpr uint32_t kCountMask = 0x7fffffff;  // the layout of FrameTargets::readSteps
    constexpr uint32_t kOutOfSteps = 1u << 31;
    TERRAY_CHECK(steps.size() == nodes.size());
    RayStatistics result;
    result.rays = steps.cells().size();
    std::vector<uint32_t> counts;  // of the rays that entered a box
    counts.reserve(result.rays);
    uint64_t sum = 0;
    for (const uint32_t cell : steps.cells()) {
        if ((cell & kCountMask) != 0) counts.push_back(cell & kCountMask);
        sum += cell & kCountMask;
        if ((cell & kOutOfSteps) != 0) ++result.outOfSteps;
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
