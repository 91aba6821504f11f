#include <chrono>
#include <memory>
#include <thread>

#include <gtest/gtest.h>

#include "client/engine/engine.h"
#include "client/render/gl_context.h"
#include "tests/support/analytic_dataset.h"

namespace terray {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;

/// Budgets of memory, on the GPU and in main memory, that are too small for the view.
class BudgetTest : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        source_ = std::make_unique<AnalyticDataset>(AnalyticDataset::Options{.imageryLevel = 3});
    }
    static void TearDownTestSuite() { source_.reset(); }
    std::unique_ptr<Engine> engine(uint64_t heightSlots, uint64_t imagerySlots, uint64_t hostBytes = 1ull << 30) {
        EngineOptions options;
        // A slot and a half each, so that the number does not hang on what a pyramid adds to a tile.
        options.gpuHeightBytes = heightSlots * GpuTiles::heightUploadBytes() * 3 / 2;
        options.gpuImageryBytes = imagerySlots * GpuTiles::imageryUploadBytes();
        options.pager.hostBudgetBytes = hostBytes;
        return std::make_unique<Engine>(*source_, shaders_, options, kWidth, kHeight);
    }
    /// Low over the ground, `along` metres from the south: from the finest level to the coarsest.
    Camera low(double along = 1000) const {
        const GroundRect ground = source_->metadata().groundBounds();
        const double x = (ground.west + ground.east) / 2, y = ground.south + along;
        Camera camera;
        camera.position = {x, y, AnalyticDataset::heightAt(x, y) + 60};
        camera.pitch = radiansFromDegrees(-6);
        return camera;
    }
    /// Frames without waiting, until nothing lacks.
    FrameReport settle(Engine& engine, const Camera& camera) {
        FrameReport report = engine.drawFrame(camera, false);
        for (int frame = 0; frame < 2000 && report.wanted > 0; ++frame) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            report = engine.drawFrame(camera, false);
        }
        EXPECT_EQ(report.wanted, 0u);
        return report;
    }
    static void expectEvenDetail(const Engine& engine, const FrameReport& report) {
        EXPECT_EQ(report.standIns, 0u) << "nothing is left coarser than the rest";
        const double most = SelectionOptions().tolerance.value() * report.coarsening.heights;
        const uint32_t finest = source_->metadata().tiling.finestLevel;
        for (const DrawNode& node : engine.nodes())
            EXPECT_TRUE(node.heightTile.level == finest || node.screenError <= most) << node.cell;
    }

    static inline std::unique_ptr<AnalyticDataset> source_;  ///< it remembers tiles that were made
    HeadlessContext context_{{.debug = true}};
    ShaderLibrary shaders_;
};

TEST_F(BudgetTest, TooSmallOnesDegradeDetailEvenlyAndSaySo) {
    double before = 1e30;
    for (const uint64_t slots : {3, 5, 7}) {
        const auto starved = engine(slots, slots);
        const FrameReport report = settle(*starved, low());
        EXPECT_GT(report.coarsening.heights, 1) << slots;
        EXPECT_GT(report.coarsening.imagery, 1) << slots;
        EXPECT_LE(report.coarsening.heights, before);
        before = report.coarsening.heights;
        expectEvenDetail(*starved, report);
        const FrameReport waited = engine(slots, slots)->drawFrame(low(), true);
        EXPECT_EQ(waited.wanted, 0u);
        EXPECT_EQ(waited.standIns, 0u);
    }
    const FrameReport ample = settle(*engine(1000, 1000), low());
    EXPECT_EQ(ample.coarsening, Coarsening());
}

TEST_F(BudgetTest, ARestingCameraLoadsNothingOnceItHasAll) {
    for (const uint64_t slots : {1, 2, 3, 6}) {
        const auto starved = engine(slots, slots, 4 << 20);
        (void)settle(*starved, low(5000));
        const uint64_t reads = settle(*starved, low()).pager.bytesRead;
        for (int frame = 0; frame < 30; ++frame) {
            const FrameReport report = starved->drawFrame(low(), false);
            EXPECT_EQ(report.uploadedTiles, 0u) << slots;
            EXPECT_EQ(report.pager.bytesRead, reads) << slots;
            EXPECT_EQ(report.wanted, 0u);
        }
    }
}

TEST_F(BudgetTest, NoneIsExceededOnAFlight) {
    constexpr uint64_t kHostBytes = 6 << 20;
    const auto starved = engine(6, 10, kHostBytes);
    const GpuTileBytes allocated = starved->tiles().allocatedBytes();
    EXPECT_LE(allocated.heights + allocated.maxima, 6 * GpuTiles::heightUploadBytes() * 3 / 2);
    EXPECT_LE(allocated.imagery, 10 * GpuTiles::imageryUploadBytes());
    uint64_t most = 0, uploaded = 0;
    for (int flight = 0; flight < 50 && uploaded <= 10; ++flight)  // a slow machine needs more than one
        for (double along = 500; along < 7500; along += 100) {
            std::this_thread::sleep_for(std::chrono::milliseconds(3));
            const FrameReport report = starved->drawFrame(low(along), false);
            most = std::max(most, report.hostBytes);
            uploaded += report.uploadedTiles;
            EXPECT_LE(report.residentHeights, starved->tiles().heightSlots());
            EXPECT_LE(report.residentImagery, starved->tiles().imagerySlots());
        }
    EXPECT_LE(most, kHostBytes);
    EXPECT_GT(most, kHostBytes / 2) << "it is used";
    EXPECT_GT(uploaded, 10u);
}

TEST_F(BudgetTest, UploadsTakeTheirShareOfTheTimeOrOneTile) {
    for (const double share : {0.0, 10.0}) {
        EngineOptions options;
        options.uploadShare = share;
        Engine engine(*source_, shaders_, options, kWidth, kHeight);
        size_t most = 0, before = 0;
        for (size_t wanted = 1; wanted > 0;) {
            const FrameReport report = engine.drawFrame(low(), false);
            wanted = report.wanted;
            if (before > 0) most = std::max(most, report.uploadedTiles);  // by then it knows what uploads cost
            before += report.uploadedTiles;
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        EXPECT_EQ(most > 1, share > 0) << share;
    }
}

TEST_F(BudgetTest, ReadsAheadOnlyWhileTheCameraMovesAndOnlyIfAllowed) {
    for (const bool prefetch : {true, false}) {
        EngineOptions options;
        options.prefetch = prefetch;
        Engine engine(*source_, shaders_, options, kWidth, kHeight);
        (void)settle(engine, low());
        EXPECT_EQ(engine.drawFrame(low(), false).pager.prefetch.tiles, 0u) << "it rests";
        PrefetchStatistics ahead;
        for (double along = 1000; along < 6000; along += 50) {
            ahead = engine.drawFrame(low(along), false).pager.prefetch;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        EXPECT_EQ(ahead.tiles > 0, prefetch);
        EXPECT_EQ(ahead.usedTiles + ahead.joined > 0, prefetch);
    }
}

TEST_F(BudgetTest, AFrameUploadsNoMoreThanItsShare) {
    EngineOptions options;
    options.uploadBytesPerFrame = 2 * GpuTiles::heightUploadBytes();
    options.uploadShare = 10;
    Engine engine(*source_, shaders_, options, kWidth, kHeight);
    uint64_t most = 0;
    FrameReport report;
    do {
        report = engine.drawFrame(low(), false);
        most = std::max(most, report.uploadedBytes);
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    } while (report.wanted > 0);
    EXPECT_LE(most, options.uploadBytesPerFrame);
    EXPECT_GT(most, GpuTiles::heightUploadBytes()) << "it is used";
}

}  // namespace
}  // namespace terray
