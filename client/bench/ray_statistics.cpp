#include "client/bench/ray_statistics.h"

#include <vector>

namespace terray {

RayStatistics measureRays(const Grid<uint32_t>& steps, const Grid<uint32_t>& nodes) {
    constexpr uint32_t kCountMask = 0xffff;  // the layout of FrameTargets::readSteps
    constexpr uint32_t kOutOfSteps = 1u << 31;
    TERRAY_CHECK(steps.size() == nodes.size());
    RayStatistics result;
    result.rays = steps.cells().size();
    std::vector<uint64_t> raysWithCount(kCountMask + 1);
    for (const uint32_t cell : steps.cells()) {
        ++raysWithCount[cell & kCountMask];
        if ((cell & kOutOfSteps) != 0) ++result.outOfSteps;
    }
    for (const uint32_t node : nodes.cells())
        if (node != 0) ++result.hit;
    result.sky = result.rays - result.hit;
    result.marched = result.rays - raysWithCount[0];
    if (result.marched == 0) return result;

    uint64_t sum = 0;
    uint64_t raysSoFar = 0;
    for (uint32_t count = 1; count <= kCountMask; ++count) {
        if (raysWithCount[count] == 0) continue;
        if (100 * raysSoFar < 99 * result.marched) result.stepsP99 = count;
        raysSoFar += raysWithCount[count];
        sum += count * raysWithCount[count];
        result.stepsMax = count;
    }
    result.stepsMean = static_cast<double>(sum) / static_cast<double>(result.marched);
    return result;
}

}  // namespace terray
