#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

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

/// How many rays took how many steps, over any number of pictures. Rays that entered no box are left out.
class StepHistogram {
  public:
    /// @param steps  as FrameTargets::readSteps
    void add(const Grid<uint32_t>& steps);
    /// Rays by their number of steps; the last entry is not 0.
    [[nodiscard]] const std::vector<uint64_t>& rays() const { return rays_; }
    /// As CSV, a line for each number of steps that a ray took. Throws Error(output).
    void write(const std::filesystem::path& path) const;

  private:
    std::vector<uint64_t> rays_;
};

}  // namespace terray
