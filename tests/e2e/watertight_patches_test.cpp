// No background through bilinear ground, nor through bilinear nodes beside nodes of columns, in either launch: pictures
// against the independent oracle, at tile borders, level jumps, holes, ridges, edges.

#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "client/stream/flight.h"
#include "tests/e2e/comparison.h"
#include "tests/e2e/patch_oracle.h"

namespace terray {
namespace {

constexpr int kWidth = 72;
constexpr int kHeight = 48;

class WatertightPatches : public testing::TestWithParam<Surface> {
  protected:
    HeadlessContext context_{HeadlessContext::Options{.debug = true}};
    ShaderLibrary shaders_;
    void TearDown() override { EXPECT_EQ(context_.takeDebugMessages(), ""); }

    static EngineOptions options(uint64_t slots = 256) {
        EngineOptions options = inspectedOptions(GetParam());
        options.gpuHeightBytes = slots * 720'000;
        return options;
    }
};

INSTANTIATE_TEST_SUITE_P(Surfaces, WatertightPatches, testing::Values(Surface::bilinear, Surface::automatic),
                         [](const auto& test) { return test.param == Surface::bilinear ? "Bilinear" : "Automatic"; });

/// A dataset, its truth, and an engine whose frames are drawn by both launches.
class Scene {
  public:
    template <class... Arguments>
    explicit Scene(const ShaderLibrary& shaders, Surface surface, const Arguments&... arguments)
        : dataset(arguments...),
          columns(dataset.source()),
          oracle(columns, surface),
          surface_(surface),
          shaders_(shaders),
          renderer_(shaders, dataset.source().metadata().tiling),
          computed_(kWidth, kHeight, inspectedOptions().features) {}

    void start(const EngineOptions& options) {
        engine_ = std::make_unique<Engine>(dataset.source(), shaders_, options, kWidth, kHeight);
    }
    /// Draws, and expects that nothing is wrong in either picture.
    Comparison draw(const Camera& camera) {
        engine_->drawFrame(camera, true);
        const Grid<PixelTruth> truth = truthOf(engine().nodes(), engine().view());
        const Comparison raster = compare(truth, engine().nodes(), engine().targets());
        const Comparison computed =
            compare(truth, engine().nodes(), drawn(engine().nodes(), Launch::compute, surface_));
        EXPECT_TRUE(raster.clean() && computed.clean())
            << "raster: " << raster << "\ncompute: " << computed << "\neye " << camera.position.x << ' '
            << camera.position.y << ' ' << camera.position.z << ", heading " << degreesFromRadians(camera.heading)
            << ", pitch " << degreesFromRadians(camera.pitch) << ", fov " << degreesFromRadians(camera.verticalFov);
        return raster;
    }
    /// A picture of nodes by the engine's last view and tiles, until the next one.
    const FrameTargets& drawn(const std::vector<DrawNode>& nodes, Launch launch, Surface surface) {
        renderer_.render(engine().view(), nodes, {}, engine().tiles(), {.launch = launch, .surface = surface},
                         computed_, nullptr);
        return computed_;
    }
    Grid<PixelTruth> truthOf(const std::vector<DrawNode>& nodes, const View& view) {
        const auto meet = [&](const auto&... arguments) { return oracle.meet(arguments...); };
        return terray::truthOf(nodes, view, dataset.source().metadata(), meet);
    }
    [[nodiscard]] const Engine& engine() const { return *engine_; }
    [[nodiscard]] glm::dvec3 above(double x, double y, double clearance) {
        return {x, y, groundAt(columns, x, y) + clearance};
    }

    ComputedDataset dataset;
    ColumnOracle columns;
    PatchOracle oracle;

  private:
    Surface surface_;
    const ShaderLibrary& shaders_;
    std::unique_ptr<Engine> engine_;
    TerrainRenderer renderer_;
    FrameTargets computed_;
};

TEST_P(WatertightPatches, RandomCamerasUnderAStarvedBudgetSeeNoHole) {
    Scene scene(shaders_, GetParam(), 4096, 5, 42);
    std::mt19937 random(2009);
    Comparison all;
    for (const uint64_t slots : {3, 6, 12, 24}) {
        scene.start(options(slots));
        for (int i = 0; i < 20; ++i) all += scene.draw(randomCamera(random, scene.columns));
    }
    EXPECT_GT(all.ground, all.pixels / 4) << "the cameras must see ground for this to mean anything";
    EXPECT_GT(all.jumps, 150) << "level jumps must be in view";
}

TEST_P(WatertightPatches, CliffsAlongTileBordersAreClosed) {
    Scene scene(shaders_, GetParam(), cliffs, GridSize{2048, 2048}, 1);
    std::mt19937 random(11);
    Comparison all;
    for (const uint64_t slots : {4, 10, 40}) {
        scene.start(options(slots));
        for (int i = 0; i < 12; ++i) all += scene.draw(randomCamera(random, scene.columns));
    }
    EXPECT_GT(all.ground, 10000);
}

/// Rough ground, a third of which is missing in pieces of all sizes.
float holed(int64_t column, int64_t row) {
    const auto wave = [](int64_t v, double length) { return std::sin(static_cast<double>(v) / length); };
    const int64_t speck = (column * 7919 + row * 104729) % 17;
    const bool missing =
        wave(column, 21) + wave(row, 34) > 1.1 || wave(column, 150) * wave(row, 130) > 0.8 || speck == 3;
    if (missing) return kNoHeight;
    return static_cast<float>(60 + 40 * wave(column, 90) * wave(row, 70)) + static_cast<float>(speck) * 0.5f;
}

TEST_P(WatertightPatches, HolesAreOpenAndTheirRimsClosed) {
    Scene scene(shaders_, GetParam(), holed, GridSize{1200, 1100}, 2);
    std::mt19937 random(5);
    Comparison all;
    for (const uint64_t slots : {2, 5, 40}) {
        scene.start(options(slots));
        for (int i = 0; i < 15; ++i) all += scene.draw(randomCamera(random, scene.columns));
        all += scene.draw(cameraAt(scene.above(2205, 3905, 30), 40, -20, 60));
        all += scene.draw(cameraAt({2200, 3900, 400}, 10, -90, 60));
    }
    EXPECT_GT(all.ground, all.pixels / 10);
    EXPECT_LT(all.ground, all.pixels * 9 / 10) << "holes must be in view";
}

TEST_P(WatertightPatches, StraightDownLowOverARidgeAndAtTheEdge) {
    Scene scene(shaders_, GetParam(), 2048, 10, 5);
    scene.start(options());
    const GroundRect ground = scene.dataset.ground();
    // The highest of some places is on a ridge.
    glm::dvec3 ridge(0, 0, -1e9);
    for (int i = 1; i < 40; ++i)
        for (int j = 1; j < 40; ++j) {
            const glm::dvec3 place = scene.above(ground.west + i * 500.0, ground.south + j * 500.0, 0);
            if (place.z > ridge.z) ridge = place;
        }
    Comparison all;
    for (int heading = 0; heading < 360; heading += 30)
        all += scene.draw(cameraAt(ridge + glm::dvec3(0, 0, 3), heading, -5, 60));
    for (const double height : {5.0, 300.0, 20000.0})
        all += scene.draw(cameraAt(scene.above(ground.west + 8000, ground.south + 7000, height), 20, -90, 60));
    // On the edge itself, looking along it, inwards and outwards; and at a corner.
    for (const double heading : {0.0, 45.0, 90.0, 180.0, 270.0}) {
        all += scene.draw(cameraAt(scene.above(ground.west + 1e-6, ground.south + 9000, 20), heading, -10, 60));
        all += scene.draw(cameraAt(scene.above(ground.east - 1e-6, ground.north - 1e-6, 20), heading, -10, 60));
    }
    EXPECT_GT(all.ground, all.pixels / 4);
}

TEST_P(WatertightPatches, TheStandardTourShowsNoHole) {
    Scene scene(shaders_, GetParam(), 2048, 10, 9);
    const Flight tour = standardTour(scene.dataset.source(), 20);
    scene.start(options());
    Comparison all;
    for (int frame = 0; frame <= 30; ++frame) all += scene.draw(tour.at(tour.seconds() * frame / 30));
    EXPECT_GT(all.ground, all.pixels / 10);
}

TEST_P(WatertightPatches, BentRaysAndExaggeratedGroundSeeNoHole) {
    Scene scene(shaders_, GetParam(), 2048, 10, 44);
    std::mt19937 random(2011);
    Comparison all;
    for (const double factor : {1.0, 4.0}) {
        EngineOptions bent = options(factor > 1 ? 5 : 24);
        bent.exaggeration = factor;
        bent.earth = kSmallEarth;
        scene.start(bent);
        for (int i = 0; i < 8; ++i) all += scene.draw(randomCamera(random, scene.columns));
    }
    EXPECT_GT(all.ground, all.pixels / 5);
}

TEST_P(WatertightPatches, TheComparisonSeesWallsThatAreCutShort) {
    Scene scene(shaders_, GetParam(), cliffs, GridSize{2048, 2048}, 1);
    scene.start(options());
    (void)scene.draw(cameraAt({1250, 4700, 400}, 110, -10, 60));
    // The same nodes with boxes that end 100 m below their tops.
    std::vector<DrawNode> cut = scene.engine().nodes();
    for (DrawNode& node : cut) node.minHeight = std::max(node.minHeight, node.maxHeight - 100);
    const Grid<PixelTruth> truth = scene.truthOf(cut, scene.engine().view());
    for (const Launch launch : {Launch::raster, Launch::compute})
        EXPECT_GT(compare(truth, cut, scene.drawn(cut, launch, GetParam())).holes, 50);
}

TEST_P(WatertightPatches, TheComparisonSeesGroundThatIsElsewhere) {
    Scene scene(shaders_, GetParam(), 1024, 10, 6);
    scene.start(options());
    const glm::dvec3 eye = scene.above(scene.dataset.ground().west + 4000, scene.dataset.ground().south + 3000, 200);
    (void)scene.draw(cameraAt(eye, 20, -25, 60));
    const std::vector<DrawNode>& nodes = scene.engine().nodes();
    // The same picture, said to be taken from farther up, or from farther down.
    for (const double away : {0.5, -0.5}) {
        View moved = scene.engine().view();
        moved.eye.z += away;
        EXPECT_GT(compare(scene.truthOf(nodes, moved), nodes, scene.engine().targets()).misplaced, 500) << away;
    }
    // Columns are not the bilinear surface.
    const Grid<PixelTruth> truth = scene.truthOf(nodes, scene.engine().view());
    const Comparison columns = compare(truth, nodes, scene.drawn(nodes, Launch::raster, Surface::columns));
    EXPECT_GT(columns.misplaced + columns.holes, 500);
}

}  // namespace
}  // namespace terray
