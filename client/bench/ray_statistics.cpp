#include "client/bench/ray_statistics.h"

#include <algorithm>
#include <span>
#include <string>

#include "client/render/frame_targets.h"
#include "common/output_file.h"

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

void StepHistogram::add(const Grid<uint32_t>& steps) {
    for (const uint32_t cell : steps.cells()) {
        const uint32_t count = cell & kStepCountMask;
        if (count == 0) continue;
        if (count >= rays_.size()) rays_.resize(count + 1);
        ++rays_[count];
    }
}

void StepHistogram::write(const std::filesystem::path& path) const {
    std::string text = "steps,rays\n";
    for (size_t steps = 0; steps < rays_.size(); ++steps)
        if (rays_[steps] > 0) text += std::to_string(steps) + ',' + std::to_string(rays_[steps]) + '\n';
    OutputFile file(path.string() + ".partial");
    file.write(std::as_bytes(std::span(text)));
    file.publish(path);
}

}  // namespace terray
