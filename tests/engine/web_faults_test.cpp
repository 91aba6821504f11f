#include <chrono>
#include <functional>
#include <memory>
#include <thread>

#include <gtest/gtest.h>

#include "client/engine/engine.h"
#include "client/render/gl_context.h"
#include "client/stream/web_dataset.h"
#include "tests/common/temporary_directory.h"
#include "tests/support/analytic_dataset.h"
#include "tests/support/fault_server.h"

namespace terray {
namespace {

constexpr int kWidth = 128;
constexpr int kHeight = 96;
using Picture = Grid<std::array<uint8_t, 4>>;

/// What a flight shows while a server fails, and afterwards.
class WebFaultPictures : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        setenv("no_proxy", "*", 1);
        folder_ = std::make_unique<test::TemporaryDirectory>();
        AnalyticDataset({.imageryLevel = 3}).write(folder_->path());
    }
    static void TearDownTestSuite() { folder_.reset(); }

    static Camera camera(const TileSource& source) {
        const GroundRect ground = source.metadata().groundBounds();
        const double x = (ground.west + ground.east) / 2, y = ground.south + 1000;
        Camera camera;
        camera.position = {x, y, AnalyticDataset::heightAt(x, y) + 60};
        camera.pitch = radiansFromDegrees(-6);
        return camera;
    }
    /// The picture with all tiles, without a server.
    Picture fullDetail() {
        const auto source = openLocalDataset(folder_->path());
        Engine engine(*source, shaders_, {}, kWidth, kHeight);
        EXPECT_EQ(engine.drawFrame(camera(*source), true).wanted, 0u);
        return engine.targets().readSrgb();
    }
    static int64_t groundPixels(const Engine& engine) {
        int64_t pixels = 0;
        const Grid<uint32_t> nodes = engine.targets().readNodes();
        for (const uint32_t node : nodes.cells()) pixels += node != 0 ? 1 : 0;
        return pixels;
    }
    /// Opens the dataset, lets `fail` happen and draws for a while, lets `mend` happen and draws until nothing lacks.
    void expectAncestorsThenFullDetail(const std::function<void()>& fail, const std::function<void()>& mend) {
        const auto source = openWebDataset(server_.address() + "/heights.pmtiles", kHasty);
        EngineOptions options;
        options.pager.healMs = 20;
        Engine engine(*source, shaders_, options, kWidth, kHeight);
        fail();
        const auto draw = [&] {
            const FrameReport report = engine.drawFrame(camera(*source), false);
            EXPECT_GT(groundPixels(engine), kWidth * kHeight / 4) << "a hole";
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
            return report;
        };
        for (int frame = 0; frame < 15; ++frame) EXPECT_GT(draw().wanted, 0u) << "nothing can have come";
        mend();
        size_t wanted = 1;
        for (int frame = 0; frame < 1000 && wanted > 0; ++frame) wanted = draw().wanted;
        EXPECT_EQ(wanted, 0u);
        EXPECT_EQ(engine.targets().readSrgb(), fullDetail());
    }

    static inline const WebOptions kHasty{
        .http = {.attempts = 4, .stallSeconds = 1, .deadlineMs = 5000, .firstBackOffMs = 5, .longestBackOffMs = 20}};
    static inline std::unique_ptr<test::TemporaryDirectory> folder_;
    HeadlessContext context_{{.debug = true}};
    ShaderLibrary shaders_;
    FaultServer server_{folder_->path()};
};

class WebFault : public WebFaultPictures, public testing::WithParamInterface<Fault> {};

TEST_P(WebFault, ShowsAncestorsAndFullDetailOnceItIsOver) {
    expectAncestorsThenFullDetail([this] { server_.setFault(GetParam()); }, [this] { server_.setFault(Fault::none); });
    EXPECT_GT(server_.faults(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Each, WebFault,
                         testing::Values(Fault::refuse, Fault::reset, Fault::truncate, Fault::corrupt, Fault::stall,
                                         Fault::trickle, Fault::status500, Fault::status503, Fault::wrongLength));

TEST_F(WebFaultPictures, ShowFullDetailOnceAKilledServerIsBack) {
    expectAncestorsThenFullDetail([this] { server_.kill(); }, [this] { server_.restart(); });
}

}  // namespace
}  // namespace terray
