// What methods other than the pyramid find, against it on the same tiles: a plane, a step, a cone, procedural ground
// with holes and level jumps. The pyramid's own answers are tested against oracles (known_answers_test,
// watertight_test).

#include <cmath>

#include <gtest/gtest.h>

#include "tests/e2e/scene.h"

namespace terray {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;

/// How a method's picture differs from the pyramid's.
struct Difference {
    int64_t ground = 0;      ///< pixels that show ground by the pyramid
    int64_t seeThrough = 0;  ///< of these, those that do not by the method
    int64_t coversSky = 0;   ///< the other way round
    int64_t near = 0;  ///< both show ground, at depths that agree to 1 in 1000 and two samples (a stair of columns)
    int64_t far = 0;

    Difference& operator+=(const Difference& other) {
        ground += other.ground;
        seeThrough += other.seeThrough;
        coversSky += other.coversSky;
        near += other.near;
        far += other.far;
        return *this;
    }
};

class MethodTest : public testing::Test {
  protected:
    HeadlessContext context_{HeadlessContext::Options{.debug = true}};
    ShaderLibrary shaders_;
    void TearDown() override { EXPECT_EQ(context_.takeDebugMessages(), ""); }

    std::unique_ptr<Engine> engineWith(const TileSource& source, const std::string& method, EngineOptions options) {
        options.render.method = methodNamed(method);
        return std::make_unique<Engine>(source, shaders_, options, kWidth, kHeight);
    }

    static Difference compare(Engine& method, Engine& pyramid, const Camera& camera, double spacing) {
        EXPECT_EQ(method.drawFrame(camera, true).nodes, pyramid.drawFrame(camera, true).nodes);
        EXPECT_EQ(raysOutOfSteps(method.targets()), 0);
        const auto nodes = method.targets().readNodes(), trueNodes = pyramid.targets().readNodes();
        const auto hits = method.targets().readHits(), trueHits = pyramid.targets().readHits();
        Difference found;
        for (int64_t y = 0; y < kHeight; ++y)
            for (int64_t x = 0; x < kWidth; ++x) {
                const bool ground = nodes.at(x, y) != 0, trueGround = trueNodes.at(x, y) != 0;
                found.ground += trueGround ? 1 : 0;
                found.seeThrough += trueGround && !ground ? 1 : 0;
                found.coversSky += ground && !trueGround ? 1 : 0;
                if (!ground || !trueGround) continue;
                const double t = trueHits.at(x, y).w;
                (std::abs(hits.at(x, y).w - t) <= 1e-3 * t + 2 * spacing ? found.near : found.far) += 1;
            }
        return found;
    }
};

/// Methods that look for the surface at samples of the ray, with enough of them for the scenes below.
const char* const kSearches[] = {"linear:least=1024,most=2048", "hull:stride=0.05,steps=600,more=600",
                                 "cones:steps=2000"};
/// And the one that has triangles instead, as close as they get.
const char* const kMesh = "mesh:error=0";

TEST_F(MethodTest, EverySearchFindsAPlaneAndAConeAndAStep) {
    const HeightFunction plane = [](int64_t, int64_t) { return 250.0f; };
    const HeightFunction cone = [](int64_t column, int64_t row) {
        return static_cast<float>(
            400 - 0.8 * std::hypot(static_cast<double>(column) - 511.5, static_cast<double>(row) - 511.5));
    };
    const HeightFunction step = [](int64_t column, int64_t) { return column < 600 ? 100.0f : 300.0f; };
    for (const HeightFunction& heights : {plane, cone, step}) {
        const ComputedDataset dataset(heights, {1024, 1024}, 1);
        for (const Surface surface : {Surface::columns, Surface::bilinear})
            for (const char* method : kSearches) {
                const auto engine = engineWith(dataset.source(), method, inspectedOptions(surface));
                const auto pyramid = engineWith(dataset.source(), "pyramid", inspectedOptions(surface));
                Difference found;
                for (const double pitch : {-60.0, -30.0, -12.0})
                    found += compare(*engine, *pyramid, cameraAt({1300, 4200, 480}, 60, pitch, 60), 1);
                EXPECT_GT(found.ground, 20000) << method;
                EXPECT_LE(found.seeThrough + found.coversSky, found.ground / 1000) << method;
                // A search steps past parts of a stair of columns, cones with steps of a whole sample.
                EXPECT_LE(found.far, found.ground / 40) << method;
            }
    }
}

TEST_F(MethodTest, StreamedGroundWithHolesAndLevelJumpsIsDrawnByEveryMethod) {
    const HeightFunction holed = [](int64_t column, int64_t row) {
        if ((column / 100 + row / 100) % 7 == 0) return kNoHeight;
        const auto x = static_cast<double>(column), y = static_cast<double>(row);
        return static_cast<float>(200 + 60 * std::sin(x / 40) * std::cos(y / 55) + 4 * std::sin(x / 5));
    };
    const ComputedDataset dataset(holed, {2048, 2048}, 2);
    for (const bool curved : {false, true})
        for (const std::string method :
             {"march", "linear", "hull:stride=0.2,steps=100,more=300", "cones", "mesh:error=0.1", "hybrid:error=0.1"}) {
            EngineOptions options = inspectedOptions();
            options.gpuHeightBytes = 6 * 720'000;  // coarse tiles beside finer ones
            options.render.method = methodNamed(method);
            options.render.drawCosts = DrawCosts{.castPixel = 1, .meshTriangle = 0.02};
            if (curved) options.earth = {.shape = EarthShape::curved, .refraction = -200};
            const auto engine = engineWith(dataset.source(), method, options);
            const auto pyramid = engineWith(dataset.source(), "pyramid", options);
            Difference found;
            for (const double heading : {20.0, 140.0, 260.0})
                found += compare(*engine, *pyramid, cameraAt({3000, 3000, 450}, heading, -25, 60), 2);
            EXPECT_GT(found.ground, 20000) << method << (curved ? " curved" : "");
            // Triangles have no walls down into holes: sky, or what is farther away, is seen there.
            const bool walls =
                options.render.method.method != Method::mesh && options.render.method.method != Method::hybrid;
            EXPECT_LE(found.seeThrough + found.coversSky, found.ground / (walls ? 50 : 15)) << method << curved;
            EXPECT_LE(found.far, found.ground / (walls ? 20 : 8)) << method << curved;
        }
}

TEST_F(MethodTest, TrianglesOfEverySampleAreThePatchesButForTheirDiagonals) {
    const HeightFunction cone = [](int64_t column, int64_t row) {
        return static_cast<float>(
            400 - 0.8 * std::hypot(static_cast<double>(column) - 511.5, static_cast<double>(row) - 511.5));
    };
    const ComputedDataset dataset(cone, {1024, 1024}, 1);
    const auto mesh = engineWith(dataset.source(), kMesh, inspectedOptions(Surface::bilinear));
    const auto pyramid = engineWith(dataset.source(), "pyramid", inspectedOptions(Surface::bilinear));
    Difference found;
    for (const double pitch : {-60.0, -30.0, -12.0, 0.0})
        for (const double heading : {60.0, 150.0, 300.0})
            found += compare(*mesh, *pyramid, cameraAt({1500, 4500, 480}, heading, pitch, 60), 1);
    EXPECT_GT(found.ground, 50000);
    // Only the skyline may be told either way, by half a pixel.
    EXPECT_LE(found.seeThrough + found.coversSky, found.ground / 1000);
    EXPECT_EQ(found.far, 0);
}

TEST_F(MethodTest, NoHoleShowsBetweenTrianglesOfTilesOfAnyLevel) {
    const ComputedDataset dataset(4096, 5, 42);
    for (const uint64_t slots : {3, 8, 40}) {
        EngineOptions options = inspectedOptions(Surface::bilinear);
        options.gpuHeightBytes = slots * 720'000;
        const auto mesh = engineWith(dataset.source(), "mesh", options);
        const auto pyramid = engineWith(dataset.source(), "pyramid", options);
        const glm::dvec3 middle(1000 + 10240, 5000 - 10240, dataset.source().metadata().maxHeight);
        Difference found;
        for (const double heading : {15.0, 100.0, 200.0, 290.0})
            for (const double pitch : {-80.0, -30.0, -8.0})
                found += compare(*mesh, *pyramid, cameraAt(middle, heading, pitch, 60), 5);
        EXPECT_GT(found.ground, 100'000);
        // Only the skyline may be told either way, by half a pixel.
        EXPECT_LE(found.seeThrough, found.ground / 1000) << slots;
        EXPECT_LE(found.coversSky, found.ground / 1000) << slots;
    }
}

TEST_F(MethodTest, AHybridOfBothWaysHasNoHoleBetweenRaysAndTriangles) {
    const ComputedDataset dataset(4096, 5, 42);
    size_t rasterised = 0, drawn = 0;
    for (const uint64_t slots : {8, 40}) {
        EngineOptions options = inspectedOptions(Surface::bilinear);
        options.gpuHeightBytes = slots * 720'000;
        options.selection.tolerance = Pixels(0.25);
        // Such that about half of the nodes are cheaper either way.
        options.render.drawCosts = DrawCosts{.castPixel = 1, .meshTriangle = 0.02};
        const auto hybrid = engineWith(dataset.source(), "hybrid", options);
        const auto pyramid = engineWith(dataset.source(), "pyramid", options);
        const glm::dvec3 middle(1000 + 10240, 5000 - 10240, dataset.source().metadata().maxHeight);
        Difference found;
        for (const double heading : {15.0, 100.0, 200.0, 290.0})
            for (const double pitch : {-60.0, -8.0}) {
                const Camera camera = cameraAt(middle, heading, pitch, 60);
                found += compare(*hybrid, *pyramid, camera, 5);
                const FrameReport report = hybrid->drawFrame(camera, true);
                rasterised += report.rasterisedNodes;
                drawn += report.nodes;
            }
        EXPECT_GT(found.ground, 50'000);
        EXPECT_LE(found.seeThrough + found.coversSky, found.ground / 1000) << slots;
    }
    EXPECT_GT(rasterised, drawn / 8);
    EXPECT_LT(rasterised, 7 * drawn / 8);
}

TEST_F(MethodTest, TheHybridOfOneWayIsThatMethod) {
    const ComputedDataset dataset(2048, 5, 42);
    EngineOptions options = inspectedOptions();
    const Camera camera = cameraAt({3000, 3000, dataset.source().metadata().maxHeight}, 30, -20, 60);
    const auto picture = [&](const std::string& method) {
        const auto engine = engineWith(dataset.source(), method, options);
        engine->drawFrame(camera, true);
        return std::pair(engine->targets().readNodes(), engine->targets().readHits());
    };
    options.render.drawCosts = DrawCosts{.meshNode = 1};
    EXPECT_TRUE(picture("hybrid") == picture("pyramid"));
    options.render.drawCosts = DrawCosts{.castNode = 1};
    EXPECT_TRUE(picture("hybrid") == picture("mesh"));
}

TEST_F(MethodTest, AFewSamplesMissAWallThatThePyramidHits) {
    // A wall of one sample, 100 m high: looked at from the side it is thinner than a step.
    const ComputedDataset wall([](int64_t column, int64_t) { return column == 300 ? 150.0f : 50.0f; }, {600, 600}, 1);
    const Camera camera = cameraAt({1100, 4700, 120}, 90, 0, 40);
    const auto pyramid = engineWith(wall.source(), "pyramid", inspectedOptions(Surface::columns));
    const auto coarse = engineWith(wall.source(), "linear:least=4,most=16", inspectedOptions(Surface::columns));
    const auto fine = engineWith(wall.source(), "linear:least=512,most=2048", inspectedOptions(Surface::columns));
    EXPECT_GT(compare(*coarse, *pyramid, camera, 1).seeThrough, 1000);
    EXPECT_EQ(compare(*fine, *pyramid, camera, 1).seeThrough, 0);
}

}  // namespace
}  // namespace terray
