// shaders/math/column.glsl against closed forms: ray against column.

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "shaders/math/math.h"
#include "tests/common/random.h"
#include "tests/shader_math/both.h"
#include "tests/shader_math/walks.h"

namespace {

namespace f = terray::mathf;
namespace d = terray::mathd;

TEST(Column, IsMetByDescendingRaysAtTheTopAndByOthersAtTheSide) {
    // Down from z = 10 at 2 a metre: below 4 from t = 3 on.
    EXPECT_TRUE(d::meetsColumn(4, 10, -2, 2, 3.5));
    EXPECT_DOUBLE_EQ(d::columnTime(4, 10, -2, -0.5, 2, 3.5), 3);
    EXPECT_FALSE(d::meetsColumn(4, 10, -2, 2, 2.9));
    // Entering below the top: at once.
    EXPECT_DOUBLE_EQ(d::columnTime(4, 10, -2, -0.5, 3.2, 3.5), 3.2);
    // Rising: decided at the entry.
    EXPECT_TRUE(d::meetsColumn(4, 3, 1, 0.5, 9));
    EXPECT_DOUBLE_EQ(d::columnTime(4, 3, 1, 1, 0.5, 9), 0.5);
    EXPECT_FALSE(d::meetsColumn(4, 3, 1, 1.5, 9));
    // Horizontal, exactly on the top: solid includes its surface.
    EXPECT_TRUE(d::meetsColumn(4, 4, 0, 0, 9));
}

TEST(Column, TimeStaysInsideTheCellWhateverTheRounding) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0, 1);
    for (int i = 0; i < 100000; ++i) {
        const float enter = 100 * unit(random);
        const float exit = enter + unit(random) * 1e-3f;
        const float top = 65535 * unit(random);
        const float directionZ = -1e4f * unit(random);
        const float eyeZ = top + enter * -directionZ * (1 + 1e-6f * unit(random));
        if (!f::meetsColumn(top, eyeZ, directionZ, enter, exit)) continue;
        const float t = f::columnTime(top, eyeZ, directionZ, f::safeInverse(directionZ), enter, exit);
        EXPECT_GE(t, enter);
        EXPECT_LE(t, exit);
    }
}

using terray::test::Double;
using terray::test::Heights;
using terray::test::Ray;

template <class Math>
class Columns : public testing::Test {};
TYPED_TEST_SUITE(Columns, terray::test::Precisions, terray::test::PrecisionNames);

TYPED_TEST(Columns, OfAStepAreMetAtTheRiserOrOnATreadByEveryKindOfRay) {
    const Heights step(16, [](int x, int) { return x < 8 ? 4 : 20; });
    const auto first = [&](Ray<TypeParam> ray) { return terray::test::walkColumns<TypeParam>(step, ray); };
    EXPECT_EQ(first({{2, 3, 30}, {0, 0, -2}}), 13);             // straight down on the lower tread
    EXPECT_EQ(first({{8, 3, 30}, {0, 0, -2}}), 5);              // down on the edge: the cell beyond it has it
    EXPECT_EQ(first({{-4, 3, 10}, {2, 0, 0}}), 6);              // level, into the riser
    EXPECT_EQ(first({{3, -4, 4}, {0, 2, 0}}), 2);               // level, along the tread's very surface
    EXPECT_EQ(first({{3, -4, 4.5}, {0, 2, 0}}), std::nullopt);  // level, above it
    EXPECT_EQ(first({{-4, 3, 10}, {2, 0, 0.5}}), 6);            // rising, 13 at the riser
    EXPECT_EQ(first({{-4, 3, 10}, {1, 0, 1}}), std::nullopt);   // rising, 22 at the riser
    EXPECT_EQ(first({{0, 0, 10}, {1, 1, -1}}), 6);              // through corners only, down on the tread at (6, 6)
    EXPECT_EQ(first({{0, 0, 12}, {1, 1, -0.5}}), 8);            // through corners only, into the riser at (8, 8)
    EXPECT_EQ(first({{-4, 3, 2}, {2, 0, 0}}), 2);               // into the grid's own side
    EXPECT_EQ(first({{4, 4, 2}, {1, 0, 1}}), 0);                // an eye below the ground
}

TYPED_TEST(Columns, OfAPlaneAreItsStaircase) {
    // Column x is 2 x high. At level 11 the first higher column is x = 6; a ray falling by 1 a texel from 30 is at 20.5
    // over the border of column 10 (20 high), and reaches 20 half a texel on.
    const Heights plane(16, [](int x, int) { return 2 * x; });
    EXPECT_EQ(terray::test::walkColumns<TypeParam>(plane, {{-2, 5, 11}, {1, 0, 0}}), 8);
    EXPECT_EQ(terray::test::walkColumns<TypeParam>(plane, {{0, 5, 30.5}, {1, 0, -1}}), 10.5);
    EXPECT_EQ(terray::test::walkColumns<TypeParam>(plane, {{0, 5, 30.5}, {0, 0, -1}}), 30.5);
}

TYPED_TEST(Columns, OfAConeAreMetWhereDensePointsAlongTheRayFirstLieInside) {
    const Heights cone(32, [](int x, int y) { return std::max(0.0, 100 - 8 * std::hypot(x - 15.5, y - 15.5)); });
    terray::test::Random random(11);
    int met = 0;
    for (int i = 0; i < 400; ++i) {
        const Ray<Double> wanted = {{-random.between(0, 20), random.between(-10, 20), random.between(20, 140)},
                                    {random.between(0.05, 1), random.between(0, 0.5), random.between(-3, 1)}};
        const Ray<TypeParam> ray = {typename TypeParam::vec3(wanted.eye), typename TypeParam::vec3(wanted.direction)};
        const auto found = terray::test::walkColumns<TypeParam>(cone, ray);
        met += found.has_value();
        const double end = found ? double{*found} : 2000;
        const double step = 1.0 / 128;
        for (double t = step / 2; t < end - 1e-4; t += step) {
            const double x = ray.x(t);
            const double y = ray.y(t);
            if (x < 0 || y < 0) continue;
            if (x > 32 || y > 32) break;
            // Rounding shifts a column's side by 1e-4 texels at most, see Column.TimeStaysInsideTheCell...
            const double away = std::min(std::abs(x - std::round(x)), std::abs(y - std::round(y)));
            if (away < 1e-4) continue;
            ASSERT_GT(ray.height(t), cone.column(x, y) - 1e-3) << i << " at " << t;
        }
        if (found) {
            double lowest = 1e9;
            for (const double x : {-1e-4, 1e-4})
                for (const double y : {-1e-4, 1e-4})
                    lowest = std::min(lowest, ray.height(end) - cone.column(ray.x(end) + x, ray.y(end) + y));
            EXPECT_LE(lowest, 1e-3) << i;
        }
    }
    EXPECT_GT(met, 100);
}

}  // namespace
