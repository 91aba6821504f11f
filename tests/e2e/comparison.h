#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "common/grid.h"
#include "common/rgba.h"
#include "tests/e2e/column_oracle.h"
#include "tests/e2e/scene.h"

namespace terray {

/// What TERRAY_SIGNAL_SKY draws where there is no ground.
inline constexpr Rgba kSignal = {255, 0, 255, 255};

/// Air that bends light up so much that the earth, of 32 km radius for the eye, drops by 6 km over 20 km.
inline constexpr EarthOptions kSmallEarth{.shape = EarthShape::curved, .refraction = -200};

/// Pixels of pictures against an oracle.
struct Comparison {
    int64_t pixels = 0;
    int64_t ground = 0;       ///< pixels whose ray is in the drawn ground, by the oracle
    int64_t holes = 0;        ///< of these, drawn as sky
    int64_t falseGround = 0;  ///< drawn as ground although the ray clears all ground by a margin
    int64_t misplaced = 0;    ///< hit elsewhere than the oracle by more than the bound
    int64_t jumps = 0;        ///< neighbouring pixels on nodes of different height levels
    int64_t outOfSteps = 0;

    void operator+=(const Comparison& other);
    /// No pixel is wrong.
    [[nodiscard]] bool clean() const { return holes + falseGround + misplaced + outOfSteps == 0; }
};
std::ostream& operator<<(std::ostream& out, const Comparison& comparison);

/// An oracle's meet().
using Truth =
    std::function<std::optional<double>(const std::vector<DrawNode>& nodes, const View& view,
                                        const glm::dvec3& direction, ColumnOracle::Columns ground, double floor)>;

/// When the ray of a pixel meets the ground.
struct PixelTruth {
    std::optional<double> sure;      ///< at the latest
    std::optional<double> possible;  ///< at the earliest
};
[[nodiscard]] Grid<PixelTruth> truthOf(const std::vector<DrawNode>& drawn, const View& view,
                                       const DatasetMetadata& metadata, const Truth& truth);

/// Every pixel of a picture against the truth of the same draw list. The targets need statistics and signal sky.
[[nodiscard]] Comparison compare(const Grid<PixelTruth>& truth, const std::vector<DrawNode>& drawn,
                                 const FrameTargets& targets);

/// Height of the finest sample at a place; NaN outside.
[[nodiscard]] double groundAt(ColumnOracle& oracle, double x, double y);

/// Random cameras above, along, over and beside the ground.
[[nodiscard]] Camera randomCamera(std::mt19937& random, ColumnOracle& oracle);

/// Blocks of 512 samples alternate between 0 and 900 m, so every tile border is a cliff; and rough inside.
[[nodiscard]] float cliffs(int64_t column, int64_t row);

}  // namespace terray
