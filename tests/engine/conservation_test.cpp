// What every way to draw keeps: a still camera's frames are the same bytes, and each ray ends exactly once.

#include <gtest/gtest.h>

#include "client/bench/measured_frame.h"
#include "client/bench/ray_statistics.h"
#include "client/render/gl_context.h"
#include "tests/support/analytic_dataset.h"

namespace terray {
namespace {

constexpr int kWidth = 128;
constexpr int kHeight = 96;

/// All that a frame leaves behind.
struct Frame {
    Grid<Rgba> picture;
    Grid<glm::vec4> hits;
    Grid<uint32_t> nodes;
    Grid<uint32_t> steps;
};

Frame drawn(Engine& engine, const Camera& camera) {
    (void)drawWhole(engine, camera);
    const FrameTargets& targets = engine.targets();
    return {targets.readSrgb(), targets.readHits(), targets.readNodes(), targets.readSteps()};
}

template <class Cell>
bool same(const Grid<Cell>& a, const Grid<Cell>& b) {
    return std::equal(a.cells().begin(), a.cells().end(), b.cells().begin(), b.cells().end());
}

class ConservationTest : public testing::Test {
  protected:
    /// Calls use(engine, name) for each method that can be drawn so, by both launches and on both surfaces.
    template <class Use>
    void forEachWay(Use use) {
        for (const MethodEntry& method : kMethods)
            for (const Launch launch : {Launch::raster, Launch::compute})
                for (const Surface surface : {Surface::columns, Surface::bilinear}) {
                    if (method.geometry && launch == Launch::compute) continue;
                    EngineOptions options;
                    options.render.method.method = method.method;
                    options.render.launch = launch;
                    options.render.surface = surface;
                    options.features.statistics = options.features.signalSky = true;
                    Engine engine(dataset_, shaders_, options, kWidth, kHeight);
                    SCOPED_TRACE(std::string(method.name) + ", " + std::string(name(launch)) +
                                 (surface == Surface::columns ? ", columns" : ", bilinear"));
                    use(engine);
                }
    }
    /// Over the middle, with the horizon in the picture and ground behind the eye.
    [[nodiscard]] Camera camera() const {
        const GroundRect ground = dataset_.metadata().groundBounds();
        Camera camera;
        camera.position = {(ground.west + ground.east) / 2, (ground.south + ground.north) / 2, 0};
        camera.position.z = AnalyticDataset::heightAt(camera.position.x, camera.position.y) + 150;
        camera.pitch = radiansFromDegrees(-8);
        camera.heading = radiansFromDegrees(33);
        return camera;
    }

    HeadlessContext context_;
    ShaderLibrary shaders_;
    AnalyticDataset dataset_{{.finestLevel = 2, .imageryLevel = 2}};
};

TEST_F(ConservationTest, AStillCameraGivesTheSameBytes) {
    forEachWay([&](Engine& engine) {
        const Frame first = drawn(engine, camera());
        for (int again = 0; again < 2; ++again) {
            const Frame next = drawn(engine, camera());
            EXPECT_TRUE(same(next.picture, first.picture));
            EXPECT_TRUE(same(next.hits, first.hits));
            EXPECT_TRUE(same(next.nodes, first.nodes));
            EXPECT_TRUE(same(next.steps, first.steps));
        }
    });
}

TEST_F(ConservationTest, EachRayEndsOnGroundInTheSkyOrGivesUp) {
    constexpr Rgba kSignal{255, 0, 255, 255};
    forEachWay([&](Engine& engine) {
        const Frame frame = drawn(engine, camera());
        const RayStatistics rays = measureRays(frame.steps, frame.nodes);
        uint64_t hits = 0, sky = 0;
        for (int64_t y = 0; y < kHeight; ++y)
            for (int64_t x = 0; x < kWidth; ++x) {
                const bool ground = frame.nodes.at(x, y) != 0;
                hits += ground ? 1 : 0;
                sky += frame.picture.at(x, y) == kSignal ? 1 : 0;
                EXPECT_EQ(frame.hits.at(x, y).w > 0, ground) << x << ", " << y;
            }
        EXPECT_GT(hits, 1000U);
        EXPECT_GT(sky, 1000U);
        EXPECT_EQ(hits + sky, uint64_t{kWidth} * kHeight) << "a pixel shows ground, or the sky behind it";
        EXPECT_EQ(rays.hit, hits);
        EXPECT_EQ(rays.sky, sky);
        EXPECT_EQ(rays.outOfSteps, 0U);
    });
}

}  // namespace
}  // namespace terray
