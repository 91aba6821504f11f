// No ray slips through between patches: chains of patches that share edges, each entered where the last one was left.
//
// Two claims, which together say that the contact is the first one: the exact clearance is nowhere below -bound before
// the contact, and within bound of 0 at it (bound: clearanceBound in walks.h). A ray that ends below the ground by more
// than the bound must report one. Measured: 0.23 of the bound at most (test properties worst_clearance).

#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "tests/common/random.h"
#include "tests/shader_math/both.h"
#include "tests/shader_math/walks.h"

namespace {

using terray::test::Heights;
using terray::test::Random;
using terray::test::Ray;
using terray::test::Worst;

template <class Math>
class Watertight : public testing::Test {
  protected:
    /// A ray from above to a point below the ground of a strip of `cells` patches or of a square of them.
    /// distance: texels from the first patch back to the eye.
    static Ray<Math> descending(Random& random, const Heights& heights, bool strip, double distance, double bend) {
        const double side = heights.side() - 1;
        const double metres = 1000;  // view depth of the end
        const double endX = strip ? side : random.between(0.3, 1) * side;
        const double endY = strip ? random.between(0, 1) : random.between(0.3, 1) * side;
        const double startX = -distance;
        const double startY = strip ? endY - random.between(0, 1) * endY * (distance + side) / side
                                    : endY - random.between(0, 1) * (distance + side);
        const double endZ = heights.bilinear(endX, endY) - random.between(1, 50);
        const double startZ = heights.highest() + random.between(1, 3000);
        const double slope = (endZ - startZ) / metres - bend * metres;
        using vec3 = typename Math::vec3;
        return {vec3(startX, startY, startZ), vec3((endX - startX) / metres, (endY - startY) / metres, slope),
                static_cast<typename Math::real>(bend)};
    }

    /// Checks the claims above for one ray that is above the ground wherever it enters the grid.
    static void expectFirstContact(const Heights& heights, const Ray<Math>& ray, terray::test::Contact<Math> found,
                                   Worst& worst) {
        const double side = heights.side() - 1;
        const double enter = std::max(-double{ray.eye.x} / double{ray.direction.x},
                                      ray.direction.y > 0 ? -double{ray.eye.y} / double{ray.direction.y} : 0.0);
        const auto above = [&](double t) { return ray.height(t) - heights.bilinear(ray.x(t), ray.y(t)); };
        const double bound = clearanceBound(ray, heights, 1000);
        if (enter > 0 && above(enter) <= bound) return;
        const double leave = std::min(1000.0, (side - double{ray.eye.x}) / double{ray.direction.x});
        ASSERT_TRUE(found.has_value() || above(leave) >= -bound) << "a ray slipped through";
        if (!found) return;
        const double contact = *found;
        ASSERT_TRUE(worst.holds(above(contact), bound)) << contact;
        const double last = std::min(contact, leave);
        for (int i = 0; i <= 200; ++i)
            ASSERT_GE(above(std::max(enter, 0.0) + (last - std::max(enter, 0.0)) * i / 200), -bound);
    }
};
TYPED_TEST_SUITE(Watertight, terray::test::Precisions, terray::test::PrecisionNames);

/// Random heights: gentle, rough, or all of a code's range from one sample to the next.
Heights randomHeights(Random& random, int side) {
    const double range = std::pow(10, random.between(0, std::log10(65535)));
    return {side, [&](int, int) { return 1 + std::floor(random.between(0, range)); }};
}

TYPED_TEST(Watertight, IsEveryStripOfPatches) {
    Random random(20);
    Worst worst("worst_clearance");
    int met = 0;
    for (int i = 0; i < 20000; ++i) {
        const Heights heights = randomHeights(random, 2 + static_cast<int>(random.below(15)));
        const double distance = std::pow(10, random.between(-1, 4));
        auto ray = this->descending(random, heights, true, distance, random.below(2) == 0 ? 0 : 1e-4);
        const auto found = terray::test::walkPatches<TypeParam>(heights, ray);
        met += found.has_value();
        ASSERT_NO_FATAL_FAILURE(this->expectFirstContact(heights, ray, found, worst)) << i;
    }
    EXPECT_GT(met, 19000);
}

TYPED_TEST(Watertight, IsEverySquareOfPatches) {
    Random random(21);
    Worst worst("worst_clearance");
    int met = 0;
    for (int i = 0; i < 5000; ++i) {
        const Heights heights = randomHeights(random, 24);
        const double distance = std::pow(10, random.between(-1, 5));
        const auto ray = this->descending(random, heights, false, distance, random.below(2) == 0 ? 0 : 1e-4);
        const auto found = terray::test::walkPatches<TypeParam>(heights, ray);
        met += found.has_value();
        ASSERT_NO_FATAL_FAILURE(this->expectFirstContact(heights, ray, found, worst)) << i;
    }
    EXPECT_GT(met, 4000);
}

TYPED_TEST(Watertight, IsEverySquareForRaysThroughCornersOnly) {
    // Both edges of every cell at equal t, from eyes whose coordinates are exact and from eyes whose are not.
    Random random(22);
    Worst worst("worst_clearance");
    for (int i = 0; i < 2000; ++i) {
        const Heights heights = randomHeights(random, 24);
        const double back = i % 2 == 0 ? static_cast<double>(random.below(1000)) : random.between(0, 1000);
        using real = typename TypeParam::real;
        const double end = heights.bilinear(23, 23) - 5;
        const real speed = real((back + 23) / 1000);
        const Ray<TypeParam> ray = {{real(-back), real(-back), real(heights.highest() + 500)},
                                    {speed, speed, real((end - heights.highest() - 500) / 1000)}};
        const auto found = terray::test::walkPatches<TypeParam>(heights, ray);
        ASSERT_TRUE(found.has_value()) << i;
        ASSERT_NO_FATAL_FAILURE(this->expectFirstContact(heights, ray, found, worst)) << i;
    }
}

}  // namespace
