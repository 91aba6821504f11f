// Raster and compute launch draw the same picture: node, hit, normal and colour of every pixel.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/e2e/scene.h"

namespace terray {
namespace {

class LaunchTest : public testing::Test {
  protected:
    HeadlessContext context_{HeadlessContext::Options{.debug = true}};
    ShaderLibrary shaders_;
    void TearDown() override { EXPECT_EQ(context_.takeDebugMessages(), ""); }

    /// An engine with one launch. Odd sizes, so that work groups overlap the picture's edge.
    std::unique_ptr<Engine> engineWith(const TileSource& source, Launch launch, EngineOptions options,
                                       GridSize picture = {157, 93}) {
        options.render.launch = launch;
        return std::make_unique<Engine>(source, shaders_, options, static_cast<int>(picture.width),
                                        static_cast<int>(picture.height));
    }

    /// Draws with both and expects the same; returns the pixels that show ground.
    int64_t expectSame(Engine& raster, Engine& compute, const Camera& camera) {
        raster.drawFrame(camera, true);
        compute.drawFrame(camera, true);
        const auto nodes = raster.targets().readNodes();
        EXPECT_TRUE(nodes == compute.targets().readNodes());
        const auto hits = raster.targets().readHits();
        const auto others = compute.targets().readHits();
        int64_t ground = 0, moved = 0;
        for (int64_t y = 0; y < nodes.height(); ++y)
            for (int64_t x = 0; x < nodes.width(); ++x) {
                if (nodes.at(x, y) == 0) continue;
                ++ground;
                moved += hits.at(x, y) != others.at(x, y);
            }
        EXPECT_EQ(moved, 0) << "hits differ";
        expectSameColours(raster.targets(), compute.targets());
        EXPECT_TRUE(raster.targets().readNormals() == compute.targets().readNormals());
        EXPECT_EQ(raysOutOfSteps(raster.targets()), 0);
        EXPECT_EQ(raysOutOfSteps(compute.targets()), 0);
        return ground;
    }
};

TEST_F(LaunchTest, BothDrawTheSamePictureOnEverySurface) {
    const ComputedDataset dataset(2048, 5, 21);
    for (const Surface surface : {Surface::columns, Surface::bilinear, Surface::automatic}) {
        const auto raster = engineWith(dataset.source(), Launch::raster, inspectedOptions(surface));
        const auto compute = engineWith(dataset.source(), Launch::compute, inspectedOptions(surface));
        const glm::dvec3 middle(1000 + 5120, 5000 - 5120, dataset.source().metadata().maxHeight);
        int64_t ground = 0;
        for (const double pitch : {-90.0, -40.0, -12.0, -3.0})
            for (const double height : {-400.0, 50.0, 3000.0})
                ground += expectSame(*raster, *compute, cameraAt(middle + glm::dvec3(0, 0, height), 30, pitch, 60));
        EXPECT_GT(ground, 10'000);
    }
}

TEST_F(LaunchTest, BothDrawTheSamePictureOverASmallEarth) {
    const ComputedDataset dataset(2048, 5, 21);
    EngineOptions options = inspectedOptions();
    options.earth = {.shape = EarthShape::curved, .refraction = -200};  // 32 km in radius to the eye
    const auto raster = engineWith(dataset.source(), Launch::raster, options);
    const auto compute = engineWith(dataset.source(), Launch::compute, options);
    const glm::dvec3 middle(1000 + 5120, 5000 - 5120, dataset.source().metadata().maxHeight);
    int64_t ground = 0;
    for (const double pitch : {-90.0, -40.0, -12.0})
        for (const double height : {-400.0, 50.0, 3000.0})
            ground += expectSame(*raster, *compute, cameraAt(middle + glm::dvec3(0, 0, height), 30, pitch, 60));
    EXPECT_GT(ground, 10'000);
}

TEST_F(LaunchTest, BothDrawTheSameSkyAndAir) {
    const ComputedDataset dataset(1024, 5, 23);
    EngineOptions options = inspectedOptions();
    options.features.signalSky = false;
    options.render.visualRange = Metres(30000);
    for (const bool sky : {false, true}) {
        options.render.sky = sky;
        const auto raster = engineWith(dataset.source(), Launch::raster, options);
        const auto compute = engineWith(dataset.source(), Launch::compute, options);
        EXPECT_GT(expectSame(*raster, *compute, cameraAt({3000, 3000, 2500}, 120, -20, 80)), 1000) << sky;
    }
}

TEST_F(LaunchTest, PicturesOfSixteenThousandPixelsAreWhole) {
    // One work group for each pixel would be 16 million in one dimension, 250 times what GL promises, and a dispatch
    // that is too large draws nothing.
    const ComputedDataset dataset(1024, 5, 26);
    for (const GridSize picture : {GridSize{16384, 3}, GridSize{3, 16384}}) {
        const auto raster = engineWith(dataset.source(), Launch::raster, inspectedOptions(), picture);
        const auto compute = engineWith(dataset.source(), Launch::compute, inspectedOptions(), picture);
        const double fieldOfView = picture.width > picture.height ? 0.02 : 100;
        const Camera camera = cameraAt({2500, -2500, 4000}, 20, -90, fieldOfView);
        EXPECT_GT(expectSame(*raster, *compute, camera), 3 * 16384 / 2) << picture.width;
    }
}

TEST_F(LaunchTest, BothDrawTheSamePictureWithoutTheIdPass) {
    const ComputedDataset dataset(1024, 5, 22);
    EngineOptions options = inspectedOptions();
    options.render.occlusion = false;
    const auto raster = engineWith(dataset.source(), Launch::raster, options);
    const auto compute = engineWith(dataset.source(), Launch::compute, options);
    EXPECT_GT(expectSame(*raster, *compute, cameraAt({3000, 3000, 2500}, 120, -20, 60)), 1000);
}

TEST_F(LaunchTest, ThousandsOfNodesAreStillDrawnFrontToBack) {
    const ComputedDataset dataset(4096, 5, 23);
    EngineOptions options = inspectedOptions(Surface::columns);
    options.selection.tolerance = Pixels(0.001);
    options.gpuHeightBytes = 256 * 720'000;
    Engine engine(dataset.source(), shaders_, options, 157, 93);
    const Camera camera = cameraAt({3000, 3000, 4000}, 120, -25, 60);
    engine.drawFrame(camera, true);
    const std::vector<DrawNode>& nodes = engine.nodes();
    ASSERT_GT(nodes.size(), 8u);
    constexpr size_t kFloating = 2825;
    // The same nodes preceded by thousands whose boxes float above all ground: the bins begin with words of nothing
    // that is hit.
    std::vector<DrawNode> many(kFloating, nodes.back());
    for (DrawNode& node : many) node.maxHeight = node.minHeight = 1e6;
    many.insert(many.end(), nodes.begin(), nodes.end());
    TerrainRenderer renderer(shaders_, dataset.source().metadata().tiling);
    FrameTargets targets(157, 93, options.features);
    renderer.render(engine.view(), many, {}, engine.tiles(), {.launch = Launch::compute, .surface = Surface::columns},
                    targets, nullptr);
    const auto drawn = targets.readNodes();
    const auto wanted = engine.targets().readNodes();
    int64_t wrong = 0;
    for (int64_t y = 0; y < drawn.height(); ++y)
        for (int64_t x = 0; x < drawn.width(); ++x) {
            const uint32_t node = wanted.at(x, y);
            wrong += drawn.at(x, y) != (node == 0 ? 0 : node + kFloating);
        }
    EXPECT_EQ(wrong, 0);
}

TEST_F(LaunchTest, ThePyramidSavesStepsAndChangesNothing) {
    const ComputedDataset dataset(2048, 5, 25);
    for (const Surface surface : {Surface::columns, Surface::bilinear}) {
        EngineOptions options = inspectedOptions(surface);
        const auto with = engineWith(dataset.source(), Launch::raster, options);
        options.render.method.method = Method::march;
        const auto without = engineWith(dataset.source(), Launch::raster, options);
        const Camera camera = cameraAt({6120, -120, dataset.source().metadata().maxHeight + 50}, 30, -65, 60);
        with->drawFrame(camera, true);
        without->drawFrame(camera, true);
        EXPECT_EQ(raysOutOfSteps(without->targets()), 0);
        const auto nodes = with->targets().readNodes();
        const auto others = without->targets().readNodes();
        const auto hits = with->targets().readHits();
        const auto otherHits = without->targets().readHits();
        const auto steps = with->targets().readSteps();
        const auto otherSteps = without->targets().readSteps();
        int64_t ground = 0, different = 0, all = 0, allWithout = 0;
        for (int64_t y = 0; y < nodes.height(); ++y)
            for (int64_t x = 0; x < nodes.width(); ++x) {
                const double t = hits.at(x, y).w;
                ground += nodes.at(x, y) != 0;
                different += nodes.at(x, y) != others.at(x, y);
                // Times of entry are rounded on other paths: 2^-20 of the distance.
                if (nodes.at(x, y) != 0) different += std::abs(t - otherHits.at(x, y).w) > t * 0x1p-20;
                all += steps.at(x, y);
                allWithout += otherSteps.at(x, y);
            }
        EXPECT_EQ(different, 0) << "of " << ground;
        EXPECT_GT(ground, 4000);
        EXPECT_GT(allWithout, 2 * all);
    }
}

TEST_F(LaunchTest, AutomaticChoosesTheFasterOfTwoThatItHasTimed) {
    const ComputedDataset dataset(1024, 5, 24);
    const auto engine = engineWith(dataset.source(), Launch::automatic, inspectedOptions());
    EXPECT_FALSE(engine->calibration().has_value());
    engine->drawFrame(cameraAt({3000, 3000, 2500}, 120, -20, 60), true);
    ASSERT_TRUE(engine->calibration().has_value());
    const auto& found = *engine->calibration();
    EXPECT_GT(found.rasterMs, 0);
    EXPECT_GT(found.computeMs, 0);
    EXPECT_EQ(found.chosen, found.computeMs < found.rasterMs ? Launch::compute : Launch::raster);
}

}  // namespace
}  // namespace terray
