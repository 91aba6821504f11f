// No background through the ground: not at tile borders, level jumps, ridges, from straight above, nor at the dataset's
// edge.

#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "client/stream/flight.h"
#include "common/rgba.h"
#include "tests/e2e/column_oracle.h"
#include "tests/e2e/scene.h"

namespace terray {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 64;

/// What TERRAY_SIGNAL_SKY draws where there is no ground.
constexpr Rgba kSignal = {255, 0, 255, 255};

/// Air that bends light up so much that the earth, of 32 km radius for the eye, drops by 6 km over 20 km.
constexpr EarthOptions kSmallEarth{.shape = EarthShape::curved, .refraction = -200};

struct Comparison {
    int64_t pixels = 0;
    int64_t ground = 0;       ///< pixels whose ray is in the drawn ground, by the oracle
    int64_t holes = 0;        ///< of these, drawn as sky
    int64_t falseGround = 0;  ///< drawn as ground although the ray clears every column by a margin
    int64_t misplaced = 0;    ///< hit elsewhere than the oracle by more than the bound
    int64_t jumps = 0;        ///< neighbouring pixels on nodes of different height levels
    int64_t outOfSteps = 0;

    void operator+=(const Comparison& other) {
        pixels += other.pixels;
        ground += other.ground;
        holes += other.holes;
        falseGround += other.falseGround;
        misplaced += other.misplaced;
        jumps += other.jumps;
        outOfSteps += other.outOfSteps;
    }
};

/// Every pixel of a picture against the oracle's answer for the same draw list.
Comparison compare(const std::vector<DrawNode>& drawn, const View& view, const FrameTargets& targets,
                   ColumnOracle& oracle) {
    Comparison result;
    const auto nodes = targets.readNodes();
    const auto hits = targets.readHits();
    const auto colours = targets.readSrgb();
    const double floor = oracle.source().metadata().minHeight;
    result.outOfSteps = raysOutOfSteps(targets);
    for (int64_t y = 0; y < nodes.height(); ++y)
        for (int64_t x = 0; x < nodes.width(); ++x) {
            ++result.pixels;
            const glm::dvec3 direction = view.direction(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
            const uint32_t node = nodes.at(x, y);
            const double t = hits.at(x, y).w;
            const auto sure = oracle.meet(drawn, view, direction, ColumnOracle::Columns::shrunk, floor);
            if (sure) {
                ++result.ground;
                if (node == 0 || colours.at(x, y) == kSignal) {
                    ++result.holes;
                } else if (t > *sure * (1 + 0x1p-18) + 0.05) {
                    ++result.misplaced;
                }
            }
            if (node != 0) {
                const auto possible = oracle.meet(drawn, view, direction, ColumnOracle::Columns::grown, floor - 1e6);
                if (!possible) ++result.falseGround;
                if (possible && t < *possible * (1 - 0x1p-18) - 0.05) ++result.misplaced;
            }
            if (x > 0 && node != 0 && nodes.at(x - 1, y) != 0) {
                const auto levelOf = [&](uint32_t n) { return drawn[n - 1].heightTile.level; };
                result.jumps += levelOf(node) != levelOf(nodes.at(x - 1, y)) ? 1 : 0;
            }
        }
    return result;
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

/// Height of the finest samples at a place, through the oracle's tiles; NaN outside.
double groundAt(ColumnOracle& oracle, const TileSource& source, double x, double y) {
    const Tiling& tiling = source.metadata().tiling;
    const auto column = static_cast<int64_t>(std::floor((x - tiling.west) / tiling.finestSpacing));
    const auto row = static_cast<int64_t>(std::floor((tiling.north - y) / tiling.finestSpacing));
    const GridSize samples = source.metadata().samples;
    if (column < 0 || row < 0 || column >= samples.width || row >= samples.height) return std::nan("");
    const TileId id{tiling.finestLevel, static_cast<uint32_t>(column / kTileCore),
                    static_cast<uint32_t>(row / kTileCore)};
    const HeightTile& tile = oracle.tile(id);
    return tile.encoding.height(tile.codes.at(column % kTileCore + kHeightApron, row % kTileCore + kHeightApron));
}

/// Random cameras above, along, over and beside the ground.
Camera randomCamera(std::mt19937& random, ColumnOracle& oracle, const ComputedDataset& dataset) {
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const GroundRect ground = dataset.ground();
    const double wide = ground.east - ground.west;
    const double x = ground.west + wide * uniform(-0.1, 1.1);
    const double y = ground.south + (ground.north - ground.south) * uniform(-0.1, 1.1);
    const double below = groundAt(oracle, dataset.source(), x, y);
    const double height =
        (std::isnan(below) ? dataset.source().metadata().minHeight : below) + wide * std::pow(10, uniform(-3.3, -0.3));
    const double pitch = uniform(0, 1) < 0.1 ? -90 : uniform(-70, 10);
    return cameraAt({x, y, height}, uniform(0, 360), pitch, uniform(20, 90));
}

TEST_F(Watertight, TwoHundredRandomCamerasUnderAStarvedBudgetShowNoHole) {
    const ComputedDataset dataset(4096, 5, 42);
    ColumnOracle oracle(dataset.source());
    std::mt19937 random(2009);
    Comparison all;
    // Budgets of 3 to 24 tiles for a view that wants more force stand-ins next to fine tiles: jumps of several levels.
    for (const uint64_t slots : {3, 6, 12, 24}) {
        EngineOptions options = inspectedOptions(Surface::columns);
        options.gpuHeightBytes = slots * 720'000;
        Engine engine(dataset.source(), shaders_, options, kWidth, kHeight);
        for (int i = 0; i < 50; ++i) {
            engine.drawFrame(randomCamera(random, oracle, dataset), true);
            const Comparison one = compare(engine, oracle);
            if (one.holes + one.falseGround + one.misplaced + one.outOfSteps > 0)
                ADD_FAILURE() << "slots " << slots << " camera " << i << ": holes " << one.holes << ", false ground "
                              << one.falseGround << ", misplaced " << one.misplaced;
            all += one;
        }
    }
    expectClean(all);
    EXPECT_GT(all.ground, all.pixels / 4) << "the cameras must see ground for this to mean anything";
    EXPECT_GT(all.jumps, 1000) << "level jumps must be in view";
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
            engine.drawFrame(randomCamera(random, oracle, dataset), true);
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
                engine.drawFrame(randomCamera(random, oracle, dataset), true);
                const Comparison one = compare(engine, oracle);
                if (one.holes + one.falseGround + one.misplaced + one.outOfSteps > 0)
                    ADD_FAILURE() << "factor " << factor << " camera " << i << ": holes " << one.holes
                                  << ", false ground " << one.falseGround << ", misplaced " << one.misplaced;
                all += one;
            }
        }
    expectClean(all);
    EXPECT_GT(all.ground, all.pixels / 5);
    EXPECT_GT(all.jumps, 500);
}

/// Blocks of 512 samples alternate between 0 and 900 m, so every tile border is a cliff; and rough inside.
float cliffs(int64_t column, int64_t row) {
    const bool high = ((column / 512) + (row / 512)) % 2 == 1;
    return static_cast<float>((high ? 900 : 0) + (column * 7919 + row * 104729) % 13);
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
            engine.drawFrame(randomCamera(random, oracle, dataset), true);
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
        return glm::dvec3(x, y, groundAt(oracle, dataset.source(), x, y) + clearance);
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
