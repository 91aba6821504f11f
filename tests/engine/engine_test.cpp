#include "client/engine/engine.h"

#include <chrono>
#include <thread>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "client/engine/dataset_camera.h"
#include "client/render/gl_context.h"
#include "common/error.h"
#include "tests/support/analytic_dataset.h"

namespace terray {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;
using Picture = Grid<std::array<uint8_t, 4>>;

class EngineTest : public testing::Test {
  protected:
    std::unique_ptr<Engine> engine(const TileSource& source, const EngineOptions& options = {}) {
        return std::make_unique<Engine>(source, shaders_, options, kWidth, kHeight);
    }
    Picture waited(const TileSource& source, const Camera& camera, const EngineOptions& options = {}) {
        const auto drawing = engine(source, options);
        EXPECT_EQ(drawing->drawFrame(camera, true).wanted, 0u);
        return drawing->targets().readSrgb();
    }
    void TearDown() override { EXPECT_EQ(context_.takeDebugMessages(), ""); }

    HeadlessContext context_{{.debug = true}};
    ShaderLibrary shaders_;
    AnalyticDataset heights_{{}};
    AnalyticDataset both_{{.imageryLevel = 3}};
    EarthModel flat_{heights_.metadata(), {.shape = EarthShape::flat}, 1, 1};
};

/// Low over the south of the dataset, looking to the north: from the finest level to the coarsest.
Camera lowCamera(const TileSource& source) {
    const GroundRect ground = source.metadata().groundBounds();
    const double x = (ground.west + ground.east) / 2;
    const double y = ground.south + 1000;
    Camera camera;
    camera.position = {x, y, AnalyticDataset::heightAt(x, y) + 60};
    camera.pitch = radiansFromDegrees(-6);
    return camera;
}

EngineOptions withSlots(uint64_t heights, uint64_t imagery) {
    EngineOptions options;
    // A slot and a half each, so that the number does not hang on what a pyramid adds to a tile.
    options.gpuHeightBytes = heights * GpuTiles::heightUploadBytes() * 3 / 2;
    options.gpuImageryBytes = imagery * GpuTiles::imageryUploadBytes();
    return options;
}

int64_t groundPixels(const Engine& engine) {
    int64_t pixels = 0;
    const Grid<uint32_t> nodes = engine.targets().readNodes();
    for (const uint32_t node : nodes.cells()) pixels += node != 0 ? 1 : 0;
    return pixels;
}

TEST_F(EngineTest, WaitingTwiceGivesTheSameBytes) {
    const Camera camera = lowCamera(both_);
    EXPECT_EQ(waited(both_, camera), waited(both_, camera));
}

TEST_F(EngineTest, TheOrderOfArrivalDoesNotShow) {
    EngineOptions manyThreads;
    manyThreads.pager = {.decodeThreads = 4, .maxRequestsInFlight = 16};
    EngineOptions oneByOne;
    oneByOne.pager = {.decodeThreads = 1, .maxRequestsInFlight = 1};
    const Camera camera = lowCamera(both_);
    EXPECT_EQ(waited(both_, camera, manyThreads), waited(both_, camera, oneByOne));
}

TEST_F(EngineTest, StreamingConvergesToTheWaitedPicture) {
    const Camera camera = lowCamera(both_);
    EngineOptions options;
    options.uploadBytesPerFrame = 1;  // one tile a frame
    const auto streaming = engine(both_, options);
    FrameReport report;
    int frames = 0;
    do {
        report = streaming->drawFrame(camera, false);
        EXPECT_LE(report.uploadedTiles, 1u);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    } while (report.wanted > 0 && ++frames < 2000);
    EXPECT_EQ(report.wanted, 0u);
    EXPECT_EQ(report.standIns, 0u);
    EXPECT_EQ(streaming->targets().readSrgb(), waited(both_, camera));
}

TEST_F(EngineTest, EachFrameOfAStreamShowsGroundWhereverTheWaitedOneDoes) {
    const Camera camera = overviewCamera(heights_.metadata(), double{kWidth} / kHeight, flat_);
    const auto streaming = engine(heights_);
    (void)streaming->drawFrame(camera, false);  // nothing but the root can be there
    const int64_t first = groundPixels(*streaming);
    (void)streaming->drawFrame(camera, true);
    EXPECT_GT(first, kWidth * kHeight / 8);
    EXPECT_NEAR(static_cast<double>(first), static_cast<double>(groundPixels(*streaming)), 0.02 * kWidth * kHeight);
}

TEST_F(EngineTest, StarvedBudgetsEndAndDraw) {
    const Camera camera = lowCamera(both_);
    for (uint64_t slots = 1; slots <= 5; ++slots) {
        const auto starved = engine(both_, withSlots(slots, slots));
        EXPECT_LE(starved->tiles().heightSlots(), slots + 1);
        for (const bool wait : {true, false, true, true}) {
            const FrameReport report = starved->drawFrame(camera, wait);
            EXPECT_LE(report.residentHeights, starved->tiles().heightSlots());
            EXPECT_LE(report.residentImagery, starved->tiles().imagerySlots());
            EXPECT_TRUE(report.failures.empty());
            EXPECT_GT(groundPixels(*starved), kWidth * kHeight / 4) << slots;
        }
    }
}

TEST_F(EngineTest, AStarvedWaitIsRepeatable) {
    const Camera camera = lowCamera(both_);
    const auto draw = [&] {
        const auto starved = engine(both_, withSlots(4, 4));
        (void)starved->drawFrame(camera, true);
        return starved->targets().readSrgb();
    };
    EXPECT_EQ(draw(), draw());
}

TEST_F(EngineTest, MoreMemoryNeverDrawsCoarser) {
    const Camera camera = lowCamera(heights_);
    size_t before = 0;
    for (const uint64_t slots : {1, 3, 6, 12, 24}) {
        const auto drawing = engine(heights_, withSlots(slots, 0));
        (void)drawing->drawFrame(camera, true);
        size_t finest = 0;
        for (const DrawNode& node : drawing->nodes()) finest = std::max<size_t>(finest, node.heightTile.level);
        EXPECT_GE(finest, before);
        before = finest;
    }
    EXPECT_EQ(before, 2u);
}

TEST_F(EngineTest, ALostTileIsToldOnceAndStoodInFor) {
    const Camera camera = lowCamera(heights_);
    const auto whole = engine(heights_);
    (void)whole->drawFrame(camera, true);
    const TileId nearest = whole->nodes().front().heightTile;
    ASSERT_GT(nearest.level, 0u);

    AnalyticDataset damaged{{}};
    damaged.lose(TileLayer::heights, nearest);
    const auto drawing = engine(damaged);
    const FrameReport first = drawing->drawFrame(camera, true);
    ASSERT_EQ(first.failures.size(), 1u);
    EXPECT_NE(first.failures[0].find(toString(nearest)), std::string::npos) << first.failures[0];
    EXPECT_GT(first.standIns, 0u);
    // Coarser ground has another skyline, not holes.
    EXPECT_NEAR(static_cast<double>(groundPixels(*drawing)), static_cast<double>(groundPixels(*whole)),
                0.02 * kWidth * kHeight);
    const uint64_t reads = damaged.reads();
    for (const bool wait : {true, false, false}) {
        const FrameReport later = drawing->drawFrame(camera, wait);
        EXPECT_TRUE(later.failures.empty());
        EXPECT_EQ(later.wanted, first.wanted);
    }
    EXPECT_EQ(damaged.reads(), reads);
}

TEST_F(EngineTest, ALostRootCannotStart) {
    for (const TileLayer layer : {TileLayer::heights, TileLayer::imagery}) {
        AnalyticDataset damaged{{.finestLevel = 0, .imageryLevel = 0}};
        damaged.lose(layer, {});
        try {
            (void)engine(damaged);
            FAIL() << "drew without a root";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::dataset) << error.what();
        }
    }
}

TEST_F(EngineTest, WithoutImageryNothingOfItExists) {
    EngineOptions ignored;
    ignored.selection.useImagery = false;
    for (const auto& drawing : {engine(heights_), engine(both_, ignored)}) {
        const FrameReport report = drawing->drawFrame(lowCamera(heights_), true);
        EXPECT_FALSE(drawing->targets().features().imagery);
        EXPECT_EQ(drawing->tiles().imageryTexture(), 0u);
        EXPECT_EQ(report.gpuTiles.imagery, 0u);
        EXPECT_EQ(report.residentImagery, 0u);
        for (const DrawNode& node : drawing->nodes()) EXPECT_FALSE(node.imageryTile);
    }
    EXPECT_TRUE(engine(both_)->targets().features().imagery);
}

TEST_F(EngineTest, HitsLieOnTheGroundInWorldCoordinates) {
    const Camera camera = lowCamera(heights_);
    const auto drawing = engine(heights_);
    (void)drawing->drawFrame(camera, true);
    const Grid<glm::vec4> hits = drawing->targets().readHits();
    const Grid<uint32_t> nodes = drawing->targets().readNodes();
    int64_t looked = 0;
    for (int row = 0; row < kHeight; row += 7)
        for (int column = 0; column < kWidth; column += 7) {
            if (nodes.at(column, row) == 0) continue;
            ++looked;
            const DrawNode& node = drawing->nodes().at(nodes.at(column, row) - 1);
            const glm::dvec3 world = drawing->worldFromHit(node, hits.at(column, row));
            const double t = hits.at(column, row).w;
            const glm::dvec3 onRay = drawing->view().eye + t * drawing->view().direction(column + 0.5, row + 0.5);
            const double spacing = heights_.metadata().tiling.spacing(node.heightTile.level);
            // Both come from float: 1e-5 of the way is 80 units in the last place of t.
            EXPECT_NEAR(glm::length(world - onRay), 0, 0.02 + 1e-5 * t);
            // A column's side may be hit anywhere between its neighbours' tops.
            EXPECT_NEAR(world.z, AnalyticDataset::heightAt(world.x, world.y), 2 * AnalyticDataset::kSteepest * spacing);
        }
    EXPECT_GT(looked, 100);
}

TEST_F(EngineTest, TheOverviewShowsTheWholeDataset) {
    for (const auto& [width, height] : {std::pair{160, 120}, std::pair{90, 160}}) {
        const double exaggeration = width > height ? 1 : 20;
        const double aspect = static_cast<double>(width) / height;
        const Camera camera = overviewCamera(heights_.metadata(), aspect, flat_, exaggeration);
        const View view = exaggerated(viewOf(camera, width, height), exaggeration);
        const GroundRect ground = heights_.metadata().groundBounds();
        for (const double x : {ground.west, ground.east})
            for (const double y : {ground.south, ground.north})
                for (const double z : {heights_.metadata().minHeight, heights_.metadata().maxHeight}) {
                    const glm::dvec3 way = glm::dvec3{x, y, exaggeration * z} - view.eye;
                    const double depth = glm::dot(way, view.forward);
                    EXPECT_GT(depth, 0);
                    EXPECT_LE(std::abs(glm::dot(way, view.right)), depth * view.tanHalfWidth());
                    EXPECT_LE(std::abs(glm::dot(way, view.up)), depth * view.tanHalfHeight);
                }
    }
}

TEST_F(EngineTest, AFrameAccountsForItsTime) {
    const auto drawing = engine(heights_);
    const FrameReport report = drawing->drawFrame(lowCamera(heights_), true);
    EXPECT_GT(report.cpuMs, 0);
    EXPECT_GE(report.frameMs, report.cpuMs);
    EXPECT_GT(report.waitMs, 0);
    EXPECT_GT(report.gpuMs[static_cast<size_t>(GpuPass::march)], 0);
    EXPECT_EQ(report.uploadedBytes, report.uploadedTiles * GpuTiles::heightUploadBytes());
    EXPECT_EQ(drawing->drawFrame(lowCamera(heights_), false).waitMs, 0);
}

TEST_F(EngineTest, ChangedOptionsAndSizesDrawWhatAnEngineDrawsThatBeganWithThem) {
    const Camera camera = lowCamera(both_);
    EngineOptions changed;
    changed.selection.tolerance = Pixels(3);
    changed.render.shading.mode = Shading::slope;
    changed.render.sunDirection = {1, 0, 1};
    changed.render.surface = Surface::bilinear;
    changed.earth.shape = EarthShape::curved;
    changed.exaggeration = 2;
    const Picture wanted = waited(both_, camera, changed);
    const Picture before = waited(both_, camera);

    Engine drawing(both_, shaders_, {}, 64, 48);
    drawing.drawFrame(camera, true);
    drawing.setOptions(changed);
    drawing.resize(kWidth, kHeight);
    drawing.drawFrame(camera, true);
    EXPECT_TRUE(drawing.targets().readSrgb() == wanted);
    drawing.setOptions({});
    drawing.drawFrame(camera, true);
    EXPECT_TRUE(drawing.targets().readSrgb() == before) << "photo and all";
}

TEST_F(EngineTest, AFrozenSelectionIsDrawnFromElsewhereAsIfItHadBeenSelectedThere) {
    const Camera camera = lowCamera(heights_);
    Camera high = camera;
    high.position.z += 3000;
    high.pitch = radiansFromDegrees(-89);
    const auto drawing = engine(heights_);
    drawing->drawFrame(camera, true);
    const size_t nodes = drawing->nodes().size();
    drawing->freezeSelection(true);
    drawing->drawFrame(high, true);
    EXPECT_EQ(drawing->nodes().size(), nodes);
    const Picture raster = drawing->targets().readSrgb();
    EXPECT_GT(groundPixels(*drawing), 0);
    // Rays meet the nodes in order: by the other launch, too, the same picture.
    EngineOptions compute = drawing->options();
    compute.render.launch = Launch::compute;
    drawing->setOptions(compute);
    drawing->drawFrame(high, true);
    EXPECT_TRUE(drawing->targets().readSrgb() == raster);
    drawing->freezeSelection(false);
    drawing->drawFrame(high, true);
    EXPECT_NE(drawing->nodes().size(), nodes);
}

TEST_F(EngineTest, APixelsPlaceIsThatOfItsHit) {
    const auto drawing = engine(heights_);
    drawing->drawFrame(lowCamera(heights_), true);
    const Grid<glm::vec4> hits = drawing->targets().readHits();
    const Grid<uint32_t> nodes = drawing->targets().readNodes();
    for (int row = 0; row < kHeight; row += 7)
        for (int column = 0; column < kWidth; column += 11) {
            const auto place = drawing->placeAt(column, row);
            ASSERT_EQ(place.has_value(), nodes.at(column, row) != 0) << column << ' ' << row;
            if (!place) continue;
            const DrawNode& node = drawing->nodes().at(nodes.at(column, row) - 1);
            EXPECT_EQ(*place, drawing->worldFromHit(node, hits.at(column, row)));
        }
    EXPECT_FALSE(drawing->placeAt(-1, 0).has_value());
    EXPECT_FALSE(drawing->placeAt(0, kHeight).has_value());
}

}  // namespace
}  // namespace terray
