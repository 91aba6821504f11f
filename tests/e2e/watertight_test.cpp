// No background through the ground: not at tile borders, level jumps, ridges, from straight above, nor at the dataset's
// edge.

#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "client/stream/flight.h"
#include "tests/e2e/column_oracle.h"
#include "tests/e2e/comparison.h"

namespace terray {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 64;

/// Every pixel of a picture against the oracle's answer for the same draw list.
Comparison compare(const std::vector<DrawNode>& drawn, const View& view, const FrameTargets& targets,
                   ColumnOracle& oracle) {
    const auto meet = [&](const auto&... arguments) { return oracle.meet(arguments...); };
    return compare(truthOf(drawn, view, oracle.source().metadata(), meet), drawn, targets);
}

/// The last frame of an engine.
Comparison compare(const Engine& engine, ColumnOracle& oracle) {
    return compare(engine.nodes(), engine.view(), engine.targets(), oracle);
}

class Watertight : public testing::Test {
  protected:
    HeadlessContext context_{HeadlessContext::Options{.debug = true}};
    ShaderLibrary shaders_;
    void TearDown() override { EXPECT_EQ(context_.takeDebugMessages(), ""); }
};

void expectClean(const Comparison& result) {
    EXPECT_EQ(result.holes, 0) << "pixels of background seen through the ground";
    EXPECT_EQ(result.falseGround, 0);
    EXPECT_EQ(result.misplaced, 0);
    EXPECT_EQ(result.outOfSteps, 0);
}

TEST_F(Watertight, TwoHundredRandomCamerasUnderAStarvedBudgetShowNoHole) {
    const ComputedDataset dataset(4096, 5, 42);
    ColumnOracle oracle(dataset.source());
    std::mt19937 random(2009);
    Comparison all;
    // Budgets of 3 to 24 tiles for a view that wants more; and every other frame does not wait, so that tiles of
    // earlier cameras stand next to coarse ones: jumps of several levels.
    for (const uint64_t slots : {3, 6, 12, 24}) {
        EngineOptions options = inspectedOptions(Surface::columns);
        options.gpuHeightBytes = slots * 720'000;
        Engine engine(dataset.source(), shaders_, options, kWidth, kHeight);
        for (int i = 0; i < 50; ++i) {
            engine.drawFrame(randomCamera(random, oracle), i % 3 == 0);
            const Comparison one = compare(engine, oracle);
            if (one.holes + one.falseGround + one.misplaced + one.outOfSteps > 0)
                ADD_FAILURE() << "slots " << slots << " camera " << i << ": holes " << one.holes << ", false ground "
                              << one.falseGround << ", misplaced " << one.misplaced;
            all += one;
        }
    }
    expectClean(all);
    EXPECT_GT(all.ground, all.pixels / 4) << "the cameras must see ground for this to mean anything";
    EXPECT_GT(all.jumps, 500) << "level jumps must be in view";
    RecordProperty("pixels", std::to_string(all.pixels));
    RecordProperty("jumps", std::to_string(all.jumps));
}

TEST_F(Watertight, ExaggeratedAndFlattenedGroundShowsNoHole) {
    const ComputedDataset dataset(4096, 5, 43);
    ColumnOracle oracle(dataset.source());
    std::mt19937 random(2010);
    Comparison all;
    for (const double factor : {5.0, 0.3}) {
        EngineOptions options = inspectedOptions(Surface::columns);
        options.exaggeration = factor;
        options.gpuHeightBytes = 8 * 720'000;
        Engine engine(dataset.source(), shaders_, options, kWidth, kHeight);
        for (int i = 0; i < 25; ++i) {
            engine.drawFrame(randomCamera(random, oracle), true);
            all += compare(engine, oracle);
        }
    }
    expectClean(all);
    EXPECT_GT(all.ground, all.pixels / 4);
    EXPECT_GT(all.jumps, 300);
}

TEST_F(Watertight, RandomCamerasOverASmallEarthShowNoHoleByEitherLaunch) {
    const ComputedDataset dataset(4096, 5, 42);
    ColumnOracle oracle(dataset.source());
    std::mt19937 random(1637);
    Comparison all;
    for (const Launch launch : {Launch::raster, Launch::compute})
        for (const double factor : {1.0, 2.0}) {
            EngineOptions options = inspectedOptions(Surface::columns);
            options.gpuHeightBytes = (factor > 1 ? 3 : 24) * 720'000;
            options.render.launch = launch;
            options.earth = kSmallEarth;
            options.exaggeration = factor;
            Engine engine(dataset.source(), shaders_, options, kWidth, kHeight);
            for (int i = 0; i < 30; ++i) {
                engine.drawFrame(randomCamera(random, oracle), i % 3 == 0);
                const Comparison one = compare(engine, oracle);
                if (one.holes + one.falseGround + one.misplaced + one.outOfSteps > 0)
                    ADD_FAILURE() << "factor " << factor << " camera " << i << ": holes " << one.holes
                                  << ", false ground " << one.falseGround << ", misplaced " << one.misplaced;
                all += one;
            }
        }
    expectClean(all);
    EXPECT_GT(all.ground, all.pixels / 5);
    EXPECT_GT(all.jumps, 150);
}

TEST_F(Watertight, CliffsAlongTileBordersAreClosed) {
    const ComputedDataset dataset(cliffs, {2048, 2048}, 1);
    ColumnOracle oracle(dataset.source());
    std::mt19937 random(11);
    Comparison all;
    for (const uint64_t slots : {4, 10, 40}) {
        EngineOptions options = inspectedOptions(Surface::columns);
        options.gpuHeightBytes = slots * 720'000;
        Engine engine(dataset.source(), shaders_, options, kWidth, kHeight);
        for (int i = 0; i < 20; ++i) {
            engine.drawFrame(randomCamera(random, oracle), true);
            all += compare(engine, oracle);
        }
    }
    expectClean(all);
    EXPECT_GT(all.ground, 10000);
}

TEST_F(Watertight, TheComparisonSeesHolesWhenWallsAreCutShort) {
    const ComputedDataset dataset(cliffs, {2048, 2048}, 1);
    ColumnOracle oracle(dataset.source());
    Engine engine(dataset.source(), shaders_, inspectedOptions(Surface::columns), kWidth, kHeight);
    engine.drawFrame(cameraAt({1250, 4700, 400}, 110, -10, 60), true);
    EXPECT_EQ(compare(engine, oracle).holes, 0);

    // The same nodes with boxes that end 100 m below their tops.
    std::vector<DrawNode> cut = engine.nodes();
    for (DrawNode& node : cut) node.minHeight = std::max(node.minHeight, node.maxHeight - 100);
    TerrainRenderer renderer(shaders_, dataset.source().metadata().tiling);
    FrameTargets targets(kWidth, kHeight, inspectedOptions(Surface::columns).features);
    renderer.render(engine.view(), cut, {}, engine.tiles(), {.surface = Surface::columns}, targets, nullptr);
    EXPECT_GT(compare(cut, engine.view(), targets, oracle).holes, 100);
}

TEST_F(Watertight, StraightDownLowOverARidgeAndAtTheEdge) {
    const ComputedDataset dataset(2048, 10, 5);
    ColumnOracle oracle(dataset.source());
    Engine engine(dataset.source(), shaders_, inspectedOptions(Surface::columns), kWidth, kHeight);
    const GroundRect ground = dataset.ground();
    const auto above = [&](double x, double y, double clearance) {
        return glm::dvec3(x, y, groundAt(oracle, x, y) + clearance);
    };
    // The highest of some places is on a ridge.
    glm::dvec3 ridge(0, 0, -1e9);
    for (int i = 1; i < 40; ++i)
        for (int j = 1; j < 40; ++j) {
            const glm::dvec3 place = above(ground.west + i * 500.0, ground.south + j * 500.0, 0);
            if (place.z > ridge.z) ridge = place;
        }
    Comparison all;
    for (int heading = 0; heading < 360; heading += 30) {
        engine.drawFrame(cameraAt(ridge + glm::dvec3(0, 0, 3), heading, -5, 60), true);
        all += compare(engine, oracle);
    }
    for (const double height : {5.0, 300.0, 20000.0}) {
        engine.drawFrame(cameraAt(above(ground.west + 8000, ground.south + 7000, height), 20, -90, 60), true);
        all += compare(engine, oracle);
    }
    // On the edge itself, looking along it, inwards and outwards; and at a corner.
    for (const double heading : {0.0, 45.0, 90.0, 180.0, 270.0}) {
        engine.drawFrame(cameraAt(above(ground.west + 1e-6, ground.south + 9000, 20), heading, -10, 60), true);
        all += compare(engine, oracle);
        engine.drawFrame(cameraAt(above(ground.east - 1e-6, ground.north - 1e-6, 20), heading, -10, 60), true);
        all += compare(engine, oracle);
    }
    expectClean(all);
}

TEST_F(Watertight, TheStandardTourOverGroundWithoutHolesShowsNone) {
    const ComputedDataset dataset(2048, 10, 9);
    ColumnOracle oracle(dataset.source());
    const Flight tour = standardTour(dataset.source(), 20);
    Engine engine(dataset.source(), shaders_, inspectedOptions(Surface::columns), kWidth, kHeight);
    Comparison all;
    for (int frame = 0; frame <= 60; ++frame) {
        engine.drawFrame(tour.at(tour.seconds() * frame / 60), true);
        all += compare(engine, oracle);
    }
    expectClean(all);
    EXPECT_GT(all.ground, all.pixels / 10);
}

}  // namespace
}  // namespace terray
