// The reference against dense marching: steps far smaller than a sample, each asked whether it is in the ground.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "common/reference/ground_caster.h"
#include "tests/reference/formula_heights.h"

namespace terray {
namespace {

using test::FormulaHeights;
using test::kNoGround;

constexpr Tiling kTiling{.west = 0, .north = 0, .finestSpacing = 1, .finestLevel = 0};

/// Rough ground, with or without holes.
class Patches {
  public:
    Patches(GridSize size, uint32_t seed, double holes) : samples_(size) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> uniform(0, 1);
        for (double& sample : samples_.cells()) {
            sample = 4 * uniform(random);
            if (uniform(random) < holes) sample = kNoGround;
        }
    }
    [[nodiscard]] FormulaHeights heights() const {
        return {samples_.size(), [this](int64_t column, int64_t row) { return samples_.at(column, row); }};
    }
    /// How far above the ground a place is, in samples from the outer corner, y to the south; infinitely where none is.
    [[nodiscard]] double above(double x, double y, double z) const {
        const double u = x - 0.5, v = y - 0.5;
        const auto west = static_cast<int64_t>(std::floor(u)), north = static_cast<int64_t>(std::floor(v));
        if (std::isnan(sample(std::llround(u), std::llround(v)))) return INFINITY;
        double sum = 0, weights = 0, mean = 0;
        int count = 0;
        for (int corner = 0; corner < 4; ++corner) {
            const double height = sample(west + corner % 2, north + corner / 2);
            if (!std::isnan(height)) mean = (mean * count + height) / (count + 1), ++count;
        }
        for (int corner = 0; corner < 4; ++corner) {
            const int64_t i = west + corner % 2, j = north + corner / 2;
            const double weight =
                (1 - std::abs(u - static_cast<double>(i))) * (1 - std::abs(v - static_cast<double>(j)));
            sum += weight * (std::isnan(sample(i, j)) ? mean : sample(i, j));
            weights += weight;
        }
        return z - sum / weights;
    }

  private:
    [[nodiscard]] double sample(int64_t column, int64_t row) const {
        if (column < 0 || row < 0 || column >= samples_.width() || row >= samples_.height()) return kNoGround;
        return samples_.at(column, row);
    }
    Grid<double> samples_;
};

struct Marched {
    int rays = 0;
    int met = 0;
};

void compareRays(const Patches& ground, GridSize size, uint32_t seed, const std::optional<EarthCurvature>& earth,
                 Marched& marched) {
    const FormulaHeights heights = ground.heights();
    const GroundCaster caster(heights, kTiling, -1e6);
    std::mt19937 random(seed);
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    constexpr double kStep = 1e-3;  // of a ray from outside one end to outside the other
    for (int n = 0; n < 60; ++n) {
        const double wide = static_cast<double>(size.width), high = static_cast<double>(size.height);
        View view;
        view.earth = earth;
        view.eye = {uniform(-3, wide + 3), uniform(-3 - high, 3), uniform(0, 9)};
        const glm::dvec3 aim(uniform(0, wide), uniform(-high, 0), uniform(-3, 5));
        const glm::dvec3 direction = aim - view.eye;
        const auto above = [&](double t) {
            const glm::dvec3 at = view.at(direction, t);
            return ground.above(at.x, -at.y, at.z);
        };
        const auto found = caster.meet(view, direction);
        double first = INFINITY;
        for (double t = 0; t < 4 && first == INFINITY; t += kStep)
            if (above(t) <= 0) first = t;
        ++marched.rays;
        if (found && *found < 4 - kStep) {
            ++marched.met;
            // Just after the contact the ray is in the ground, but for one that grazes it.
            EXPECT_LE(above(*found + 1e-9), 1e-6) << "ray " << n << " of " << seed;
            EXPECT_GE(first, *found - 1e-9) << "ray " << n << " of " << seed;
        } else {
            EXPECT_EQ(first, INFINITY) << "ray " << n << " of " << seed;
        }
    }
}

TEST(DenseMarch, FindsNothingThatTheReferenceMissesOnRoughGround) {
    Marched marched;
    for (uint32_t seed = 1; seed <= 20; ++seed)
        compareRays(Patches({11, 9}, seed, 0), {11, 9}, seed, std::nullopt, marched);
    EXPECT_GT(marched.met, marched.rays / 2);
}

TEST(DenseMarch, FindsNothingThatTheReferenceMissesAmongHoles) {
    Marched marched;
    for (uint32_t seed = 1; seed <= 20; ++seed)
        compareRays(Patches({11, 9}, seed, 0.4), {11, 9}, seed, std::nullopt, marched);
    EXPECT_GT(marched.met, marched.rays / 3);
}

TEST(DenseMarch, FindsNothingThatTheReferenceMissesOverACurvedEarth) {
    Marched marched;
    for (uint32_t seed = 1; seed <= 20; ++seed)
        compareRays(Patches({11, 9}, seed, 0.1), {11, 9}, seed, EarthCurvature{0.06, 0.01, 0.04}, marched);
    EXPECT_GT(marched.met, marched.rays / 3);
}

TEST(DenseMarch, FindsNothingThatTheReferenceMissesAcrossSquares) {
    Marched marched;  // two squares of 512 patches and blocks of 16
    const GridSize size{530, 20};
    compareRays(Patches(size, 3, 0.05), size, 3, std::nullopt, marched);
    EXPECT_GT(marched.met, marched.rays / 2);
}

}  // namespace
}  // namespace terray
