// shaders/math/cell_walk.glsl against closed forms: from cell to cell.

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "shaders/math/math.h"
#include "tests/common/random.h"
#include "tests/shader_math/both.h"

namespace {

namespace f = terray::mathf;
namespace d = terray::mathd;

/// Cells of a mirrored ray by the walk of cell_walk.glsl at one level, checked against the cells that dense points lie
/// in.
template <class Walk>
void expectCellsInOrder(double slopeX, double slopeY) {
    const d::vec2 eye(0.3, 0.7);
    const d::vec2 dir(slopeX, slopeY);
    const d::vec2 inverse(d::safeInverse(dir.x), d::safeInverse(dir.y));
    d::ivec2 cell(0, 0);
    double t = 0;
    while (cell.x < 40 && cell.y < 40) {
        const d::ivec2 edge = d::blockEdge(cell, 0);
        const d::vec2 times = d::edgeTimes(edge, eye, inverse);
        const double leave = std::min(times.x, times.y);
        ASSERT_GE(leave, t);
        const double middle = 0.5 * (t + leave);
        if (leave - t > 1e-9) {
            EXPECT_EQ(cell.x, static_cast<int>(std::floor(eye.x + middle * dir.x)));
            EXPECT_EQ(cell.y, static_cast<int>(std::floor(eye.y + middle * dir.y)));
        }
        const d::ivec2 next = d::cellAfter(cell, edge, times, eye, dir);
        ASSERT_EQ((next.x - cell.x) + (next.y - cell.y), 1) << "one edge at a time";
        cell = next;
        t = leave;
    }
}

TEST(CellWalk, VisitsEveryCellOfTheRayInOrder) {
    for (const auto& [x, y] :
         {std::pair{1.0, 0.37}, {0.37, 1.0}, {1.0, 1.0}, {1.0, 0.0}, {0.0, 1.0}, {1.0, 1e-9}, {0.2, 3.0}})
        expectCellsInOrder<d::vec2>(x, y);
}

TEST(CellWalk, ProgressesThroughEveryCornerOfADiagonal) {
    // Through all corners: both edges at equal t. x is crossed first, then y; no cell is visited twice.
    const f::vec2 eye(0, 0);
    const f::vec2 dir(0.1f, 0.1f);
    const f::vec2 inverse(f::safeInverse(dir.x), f::safeInverse(dir.y));
    f::ivec2 cell(0, 0);
    int steps = 0;
    while (cell.x < 512 && cell.y < 512) {
        const f::ivec2 edge = f::blockEdge(cell, 0);
        const f::ivec2 next = f::cellAfter(cell, edge, f::edgeTimes(edge, eye, inverse), eye, dir);
        ASSERT_EQ((next.x - cell.x) + (next.y - cell.y), 1);
        cell = next;
        ++steps;
    }
    EXPECT_LE(steps, 1024);
}

TEST(CellWalk, ClimbsOnlyWhenATwoByTwoGroupIsLeft) {
    const d::vec2 throughX(1, 2);
    EXPECT_EQ(d::levelAfter(3, 8, d::ivec2(8, 8), throughX), 3);      // edge 8 >> 3 = 1: odd, within the group
    EXPECT_EQ(d::levelAfter(3, 8, d::ivec2(16, 8), throughX), 4);     // edge 16 >> 3 = 2: even, group left
    EXPECT_EQ(d::levelAfter(8, 8, d::ivec2(512, 256), throughX), 8);  // never above the coarsest
}

TEST(CellWalk, EdgesAndCellsFollowTheLevel) {
    EXPECT_EQ(d::blockEdge(d::ivec2(5, 9), 0), d::ivec2(6, 10));
    EXPECT_EQ(d::blockEdge(d::ivec2(5, 9), 2), d::ivec2(8, 12));
    EXPECT_EQ(d::cellAt(3.5, d::ivec2(4, 0), d::ivec2(8, 4), d::vec2(1, 0), d::vec2(1, 0)), d::ivec2(4, 0));
    EXPECT_EQ(d::cellAt(30, d::ivec2(4, 0), d::ivec2(8, 4), d::vec2(1, 0), d::vec2(1, 0)), d::ivec2(7, 0));
}

template <class Math>
class Walk : public testing::Test {
  protected:
    struct Result {
        int advances = 0;                          // to another block
        int descents = 0;                          // to a finer level
        std::vector<typename Math::ivec2> leaves;  // cells visited at level 0
    };

    /// The loop of march.glsl over 512 x 512 cells: pyramid level by level, where `meets` tells whether the ray meets a
    /// block. Checks what must hold at each step: t never falls, cell.x + cell.y never falls and rises with each
    /// advance, and no pair of cell and level comes twice.
    template <class Meets>
    static Result through(typename Math::vec2 eye, typename Math::vec2 direction, int coarsest, Meets meets) {
        const typename Math::vec2 inverse = terray::test::inverseOf<Math>(direction);
        const auto box = Math::boxInterval({eye.x, eye.y, 0}, {inverse.x, inverse.y, 1}, {0, 0, -1}, {512, 512, 1});
        Result result;
        typename Math::real t = box.enter;
        const auto first = [](typename Math::real at) { return std::clamp(static_cast<int>(std::floor(at)), 0, 511); };
        typename Math::ivec2 cell(first(eye.x + t * direction.x), first(eye.y + t * direction.y));
        int level = coarsest;
        while (cell.x < 512 && cell.y < 512) {
            const typename Math::ivec2 edge = Math::blockEdge(cell, level);
            const typename Math::vec2 times = Math::edgeTimes(edge, eye, inverse);
            const typename Math::real leave = std::max(t, std::min(times.x, times.y));
            if (level == 0) result.leaves.push_back(cell);
            const typename Math::ivec2 before = cell;
            if (level > 0 && meets(cell, level)) {
                // The contact may lie anywhere within the block; the ends are the worst.
                t = (cell.x + cell.y + level) % 2 == 0 ? t : leave;
                cell = Math::cellAt(t, cell, edge, eye, direction);
                --level;
                ++result.descents;
                EXPECT_TRUE(cell.x >= before.x && cell.y >= before.y && cell.x < edge.x && cell.y < edge.y);
            } else {
                cell = Math::cellAfter(cell, edge, times, eye, direction);
                level = Math::levelAfter(level, coarsest, edge, times);
                t = leave;
                ++result.advances;
                EXPECT_TRUE(cell.x >= before.x && cell.y >= before.y);
                EXPECT_GT(cell.x + cell.y, before.x + before.y) << "held back at " << before.x << ' ' << before.y;
                // The other coordinate stays within the block, so no block beside the ray's is skipped to.
                EXPECT_TRUE(cell.x == edge.x ? cell.y < edge.y : cell.y == edge.y);
            }
            if (result.advances > 1024 || testing::Test::HasFailure()) break;
        }
        EXPECT_LE(result.advances, 1024);
        EXPECT_LE(result.descents, result.advances + coarsest);
        return result;
    }
};
TYPED_TEST_SUITE(Walk, terray::test::Precisions, terray::test::PrecisionNames);

TYPED_TEST(Walk, AdvancesFromEyesOfAnyDistanceToTheLastCells) {
    // At 1e7 texels a float's last place is a texel: a nudge along the ray would vanish, an integer edge does not.
    using real = typename TypeParam::real;
    using vec2 = typename TypeParam::vec2;
    terray::test::Random random(31);
    for (const double distance : {0.0, 1e5, 1e6, 1e7, 1e9})
        for (int i = 0; i < 200; ++i) {
            // Through a point of the far cells, at 1000 m of view depth.
            const double angle = random.between(0, 1.5707963);
            const double aimX = random.between(500, 512);
            const double aimY = random.between(500, 512);
            const vec2 direction(real(std::cos(angle) * (distance + 500) / 1000),
                                 real(std::sin(angle) * (distance + 500) / 1000));
            const vec2 eye(real(aimX - 1000 * std::cos(angle) * (distance + 500) / 1000),
                           real(aimY - 1000 * std::sin(angle) * (distance + 500) / 1000));
            const auto result = this->through(eye, direction, 0, [](auto, int) { return false; });
            ASSERT_FALSE(testing::Test::HasFailure()) << distance << ' ' << i;
            EXPECT_LE(result.leaves.size(), 1024u);
        }
}

TYPED_TEST(Walk, AdvancesAlongAxesAndAlongBordersOfBlocks) {
    using real = typename TypeParam::real;
    for (const real y : {real{0}, real{0.5}, real{256}, real{511}, real{511.5}})
        for (const real back : {real{0}, real{3}, real{1e7}}) {
            const auto along = this->through({-back, y}, {1, 0}, 0, [](auto, int) { return false; });
            EXPECT_EQ(along.leaves.size(), 512u) << y;
            for (const auto& cell : along.leaves) EXPECT_EQ(cell.y, static_cast<int>(y));
            const auto across = this->through({y, -back}, {0, 2}, 0, [](auto, int) { return false; });
            EXPECT_EQ(across.leaves.size(), 512u) << y;
            for (const auto& cell : across.leaves) EXPECT_EQ(cell.x, static_cast<int>(y));
        }
}

TYPED_TEST(Walk, DoesNotPlayPingPongBetweenLevelsThroughCornersOfBlocks) {
    // Both edges of every block of every level at equal t. Climbing and descending alternate as often as they can.
    using real = typename TypeParam::real;
    using vec2 = typename TypeParam::vec2;
    for (const double speed : {1.0, 0.1, 3.7})
        for (const double start : {0.0, -256.0, -1e5, -1e6 / 3})
            for (const int coarsest : {0, 1, 4, 8}) {
                const vec2 eye(static_cast<real>(start), static_cast<real>(start));
                const vec2 direction(static_cast<real>(speed), static_cast<real>(speed));
                const auto always = this->through(eye, direction, coarsest, [](auto, int) { return true; });
                ASSERT_FALSE(testing::Test::HasFailure()) << speed << ' ' << start << ' ' << coarsest;
                EXPECT_EQ(always.leaves.back(), typename TypeParam::ivec2(511, 511));
                const auto never = this->through(eye, direction, coarsest, [](auto, int) { return false; });
                EXPECT_LE(never.advances, 2 * (512 >> coarsest));
            }
}

TYPED_TEST(Walk, BoundsItsStepsWhateverBlocksAreMet) {
    using real = typename TypeParam::real;
    using vec2 = typename TypeParam::vec2;
    terray::test::Random random(32);
    for (int i = 0; i < 2000; ++i) {
        const double distance = std::pow(10, random.between(0, 7));
        const double angle = random.between(0, 1.5707963);
        const vec2 eye(real(random.between(0, 512) - distance * std::cos(angle)),
                       real(random.between(0, 512) - distance * std::sin(angle)));
        const double odds = random.between(0, 1);
        this->through(eye, {real(std::cos(angle)), real(std::sin(angle))}, static_cast<int>(random.below(9)),
                      [&](auto, int) { return random.between(0, 1) < odds; });
        ASSERT_FALSE(testing::Test::HasFailure()) << i;
    }
}

TYPED_TEST(Walk, CrossesIntoTheCellThatTheExactRayCrossesInto) {
    // After an edge the other coordinate is the exact one rounded down, unless that lies as near to an integer as
    // rounding reaches: three roundings of the eye's and of the path's texels.
    using real = typename TypeParam::real;
    using vec2 = typename TypeParam::vec2;
    using ivec2 = typename TypeParam::ivec2;
    terray::test::Random random(33);
    int certain = 0;
    for (int i = 0; i < 100000; ++i) {
        const double distance = std::pow(10, random.between(0, 6));
        const double angle = random.between(0.1, 1.4);
        const vec2 eye(real(-distance * std::cos(angle)), real(-distance * std::sin(angle)));
        const vec2 direction(real(std::cos(angle)), real(std::sin(angle)));
        const int level = static_cast<int>(random.below(9));
        const ivec2 cell(static_cast<int>(random.below(512)), static_cast<int>(random.below(512)));
        const ivec2 edge = TypeParam::blockEdge(cell, level);
        const vec2 times = TypeParam::edgeTimes(edge, eye, terray::test::inverseOf<TypeParam>(direction));
        const ivec2 next = TypeParam::cellAfter(cell, edge, times, eye, direction);
        const bool throughX = times.x <= times.y;
        const int axis = throughX ? 0 : 1;
        const long double t = (edge[axis] - static_cast<long double>(eye[axis])) / direction[axis];
        const long double other = eye[1 - axis] + t * direction[1 - axis];
        const double bound = 4 * terray::test::kRoundoff<TypeParam> *
                             (2 * std::abs(double{eye[1 - axis]}) + 2 * static_cast<double>(std::abs(other)));
        if (std::abs(other - std::round(other)) <= bound) continue;
        ++certain;
        const int exact = static_cast<int>(std::floor(other));
        ASSERT_EQ(next[1 - axis], std::clamp(exact, cell[1 - axis], std::max(edge[1 - axis] - 1, cell[1 - axis]))) << i;
        ASSERT_EQ(next[axis], edge[axis]);
    }
    EXPECT_GT(certain, 20000);
}

}  // namespace
