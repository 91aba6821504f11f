// Terrains whose pictures can be computed: a plane, a step, a cone, a spike. Built, streamed, cast, compared per pixel.

#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/e2e/scene.h"

namespace terray {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;

class KnownAnswers : public testing::Test {
  protected:
    HeadlessContext context_{HeadlessContext::Options{.debug = true}};
    ShaderLibrary shaders_;

    void TearDown() override { EXPECT_EQ(context_.takeDebugMessages(), ""); }

    /// World positions of all hits; calls visit(column, row, node index + 1, position, view depth).
    template <class Visit>
    void forEachPixel(const Engine& engine, const Visit& visit) {
        const auto hits = engine.targets().readHits();
        const auto nodes = engine.targets().readNodes();
        for (int64_t y = 0; y < kHeight; ++y)
            for (int64_t x = 0; x < kWidth; ++x) {
                const uint32_t node = nodes.at(x, y);
                const glm::vec4 hit = hits.at(x, y);
                visit(x, y, node, node == 0 ? glm::dvec3(0) : engine.worldFromHit(engine.nodes()[node - 1], hit),
                      hit.w);
            }
    }
};

TEST_F(KnownAnswers, PlaneIsHitWhereEachRayMeetsIt) {
    const ComputedDataset plane([](int64_t, int64_t) { return 250.0f; }, {1300, 1100}, 2);
    Engine engine(plane.source(), shaders_, inspectedOptions(Surface::columns), kWidth, kHeight);
    const glm::dvec3 eye(2000, 3800, 650);
    const auto report = engine.drawFrame(cameraAt(eye, 30, -35), true);
    EXPECT_EQ(report.wanted, 0u);
    const GroundRect ground = plane.ground();
    int hitCount = 0;
    forEachPixel(engine, [&](int64_t x, int64_t y, uint32_t node, glm::dvec3 at, double t) {
        const glm::dvec3 direction =
            engine.view().direction(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
        const double expected = direction.z < 0 ? (250 - eye.z) / direction.z : -1;
        const glm::dvec3 place = eye + expected * direction;
        const bool inside = expected > 0 && place.x > ground.west + 1 && place.x < ground.east - 1 &&
                            place.y > ground.south + 1 && place.y < ground.north - 1;
        if (!inside) return;
        ASSERT_NE(node, 0u) << x << ' ' << y;
        ++hitCount;
        EXPECT_NEAR(t, expected, 1e-5 * expected) << x << ' ' << y;  // float: 2^-23 of the eye's distance, a few times
        EXPECT_NEAR(at.z, 250, 0.006);                               // quantum 1 cm, half of it, and float
        EXPECT_NEAR(at.x, place.x, 2e-5 * expected);
        EXPECT_NEAR(at.y, place.y, 2e-5 * expected);
    });
    EXPECT_GT(hitCount, kWidth * kHeight / 2);
    EXPECT_EQ(raysOutOfSteps(engine.targets()), 0);
    const Grid<glm::vec3> normals = engine.targets().readNormals();
    for (const glm::vec3& normal : normals.cells())
        if (normal != glm::vec3(0)) {
            EXPECT_NEAR(normal.z, 1, 1e-3);
        }
}

TEST_F(KnownAnswers, StepShowsItsWallAtItsPlace) {
    // 100 m to the west of column 600, 300 m to the east: the wall stands at x = 1000 + 600 * 1 m.
    const ComputedDataset step([](int64_t column, int64_t) { return column < 600 ? 100.0f : 300.0f; }, {1200, 1200}, 1);
    Engine engine(step.source(), shaders_, inspectedOptions(Surface::columns), kWidth, kHeight);
    const glm::dvec3 eye(1300, 4400, 200);
    engine.drawFrame(cameraAt(eye, 90, 0), true);
    int wall = 0;
    int floor = 0;
    forEachPixel(engine, [&](int64_t x, int64_t y, uint32_t node, glm::dvec3 at, double) {
        const glm::dvec3 direction =
            engine.view().direction(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
        const double toWall = (1600 - eye.x) / direction.x;
        const double z = eye.z + toWall * direction.z;
        const double north = eye.y + toWall * direction.y;
        if (north > step.ground().north - 1 || north < step.ground().south + 1) return;
        if (z > 102 && z < 298) {
            ASSERT_NE(node, 0u);
            EXPECT_NEAR(at.x, 1600, 0.01);
            EXPECT_NEAR(at.z, z, 0.02);
            ++wall;
        } else if (z < 98) {
            ASSERT_NE(node, 0u);
            EXPECT_NEAR(at.z, 100, 0.02);
            ++floor;
        } else if (z > 302) {
            EXPECT_EQ(node, 0u);
        }
    });
    EXPECT_GT(wall, 1000);
    EXPECT_GT(floor, 100);
}

TEST_F(KnownAnswers, ConeIsHitWithinOneColumnOfItsSlope) {
    // Apex 400 m at the middle, slope 0.8: a column of 1 m differs from the cone by at most 0.8 * sqrt(2) / 2 m.
    constexpr double kSlope = 0.8;
    const auto cone = [](int64_t column, int64_t row) {
        return static_cast<float>(
            400 - kSlope * std::hypot(static_cast<double>(column) - 511.5, static_cast<double>(row) - 511.5));
    };
    const ComputedDataset dataset(cone, {1024, 1024}, 1);
    EngineOptions options = inspectedOptions(Surface::columns);
    options.selection.tolerance = Pixels(1e-6);  // always the finest level
    Engine engine(dataset.source(), shaders_, options, kWidth, kHeight);
    engine.drawFrame(cameraAt({1512, 3800, 500}, 0, -12), true);
    int hitCount = 0;
    forEachPixel(engine, [&](int64_t, int64_t, uint32_t node, glm::dvec3 at, double) {
        if (node == 0) return;
        if (at.y < dataset.ground().south + 0.01) return;  // the cut at the dataset's edge
        const double surface = 400 - kSlope * std::hypot(at.x - 1512, at.y - 4488);
        // On a column's top or on its wall: between its own and the lower neighbour's top, one column on.
        EXPECT_NEAR(at.z, surface, kSlope * std::sqrt(2.0) + 0.02);
        ++hitCount;
    });
    EXPECT_GT(hitCount, 4000);
}

TEST_F(KnownAnswers, SpikeOfOneSampleStandsWhereItIs) {
    // 2 m of ground, one sample of 500 m: column 700, row 300, so x in [1700, 1701), y in (4699, 4700].
    const ComputedDataset spike([](int64_t column, int64_t row) { return column == 700 && row == 300 ? 500.0f : 2.0f; },
                                {1500, 700}, 1);
    EngineOptions options = inspectedOptions(Surface::columns);
    Engine engine(spike.source(), shaders_, options, kWidth, kHeight);
    const glm::dvec3 eye(1700.5, 4600, 100);
    engine.drawFrame(cameraAt(eye, 0, 0, 10), true);
    int seen = 0;
    forEachPixel(engine, [&](int64_t x, int64_t y, uint32_t node, glm::dvec3 at, double) {
        const glm::dvec3 direction =
            engine.view().direction(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
        const double t = (4699 - eye.y) / direction.y;
        const double acrossFace = eye.x + t * direction.x;
        if (acrossFace > 1700.01 && acrossFace < 1700.99) {
            ASSERT_NE(node, 0u);
            EXPECT_NEAR(at.y, 4699, 0.01);
            ++seen;
        } else if ((acrossFace < 1699.9 || acrossFace > 1701.1) && direction.z > 0) {
            EXPECT_EQ(node, 0u);
        }
    });
    EXPECT_GT(seen, 500);
}

TEST_F(KnownAnswers, OneSampleIsADataset) {
    const ComputedDataset dot([](int64_t, int64_t) { return 7.0f; }, {1, 1}, 10);
    Engine engine(dot.source(), shaders_, inspectedOptions(Surface::columns), kWidth, kHeight);
    engine.drawFrame(cameraAt({1005, 4995, 47}, 0, -90), true);
    int hitCount = 0;
    forEachPixel(engine, [&](int64_t, int64_t, uint32_t node, glm::dvec3 at, double t) {
        if (node == 0) return;
        EXPECT_NEAR(at.z, 7, 0.006);
        EXPECT_NEAR(t, 40, 0.01);
        ++hitCount;
    });
    // 10 m at 40 m through 45 degrees over 120 pixels: 10 / 40 * 120 / (2 tan 22.5) = 36.2 pixels a side.
    EXPECT_NEAR(std::sqrt(hitCount), 36.2, 1);
}

TEST_F(KnownAnswers, HolesShowWhatLiesBehindThem) {
    const ComputedDataset holed(
        [](int64_t column, int64_t row) {
            return column >= 200 && column < 300 && row >= 200 && row < 300 ? kNoHeight : 50.0f;
        },
        {512, 512}, 1);
    EngineOptions options = inspectedOptions(Surface::columns);
    Engine engine(holed.source(), shaders_, options, kWidth, kHeight);
    engine.drawFrame(cameraAt({1250, 4750, 250}, 0, -90), true);
    const auto nodes = engine.targets().readNodes();
    EXPECT_EQ(nodes.at(kWidth / 2, kHeight / 2), 0u) << "through the hole";
    EXPECT_NE(nodes.at(2, 2), 0u);
}

}  // namespace
}  // namespace terray
