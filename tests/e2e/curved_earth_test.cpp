// Pictures over a curved earth against closed forms: the dip of the horizon, what it hides, no sky below it.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/e2e/scene.h"

namespace terray {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;
constexpr double kMeanRadius = 6371008.8;  // metres; datasets without a coordinate system lie on such a sphere

/// 819 km of ground in samples of 800 m; its middle is far from all edges.
constexpr GridSize kSamples{1024, 1024};
constexpr double kSpacing = 800;
constexpr glm::dvec2 kMiddle{1000 + 512 * kSpacing, 5000 - 512 * kSpacing};

EngineOptions curved(Launch launch, Surface surface, double refraction = 0) {
    EngineOptions options = inspectedOptions(surface);
    options.render.launch = launch;
    options.earth = {.shape = EarthShape::curved, .refraction = refraction};
    return options;
}

class CurvedEarth : public testing::TestWithParam<std::tuple<Launch, Surface>> {
  protected:
    HeadlessContext context_{HeadlessContext::Options{.debug = true}};
    ShaderLibrary shaders_;
    void TearDown() override { EXPECT_EQ(context_.takeDebugMessages(), ""); }

    EngineOptions options(double refraction = 0) {
        return curved(std::get<Launch>(GetParam()), std::get<Surface>(GetParam()), refraction);
    }
};

/// Row of the picture, in pixels from the top, at which a column's rays leave the eye at an elevation.
double rowOf(const View& view, double column, double elevation) {
    double above = 0, below = view.height;
    const auto slope = [&](double row) {
        const glm::dvec3 ray = view.direction(column, row);
        return ray.z / std::hypot(ray.x, ray.y);
    };
    for (int i = 0; i < 60; ++i) {
        const double middle = (above + below) / 2;
        (slope(middle) > std::tan(elevation) ? above : below) = middle;
    }
    return above;
}

TEST_P(CurvedEarth, TheHorizonOfTheSeaDipsByTheAngleOfTheSphere) {
    const ComputedDataset sea([](int64_t, int64_t) { return 0.0f; }, kSamples, kSpacing);
    for (const double refraction : {0.0, kStandardRefraction}) {
        Engine engine(sea.source(), shaders_, options(refraction), kWidth, kHeight);
        for (const double height : {100.0, 2000.0, 9000.0}) {
            const double radius = kMeanRadius / (1 - refraction);
            const double dip = std::acos(radius / (radius + height));
            for (const double heading : {0.0, 77.0, 200.0}) {
                // 3 degrees over 120 rows: a row is 90 arcseconds.
                engine.drawFrame(cameraAt({kMiddle, height}, heading, -dip * 180 / M_PI + 0.3, 3), true);
                const Grid<uint32_t> nodes = engine.targets().readNodes();
                for (int64_t column = 0; column < kWidth; ++column) {
                    const double expected = rowOf(engine.view(), static_cast<double>(column) + 0.5, -dip);
                    int64_t sky = 0;
                    while (sky < kHeight && nodes.at(column, sky) == 0) ++sky;
                    // The horizon lies between the centres of the last row of sky and the first of ground.
                    ASSERT_NEAR(static_cast<double>(sky), expected, 0.55) << height << " m, heading " << heading;
                    for (int64_t row = sky; row < kHeight; ++row) ASSERT_NE(nodes.at(column, row), 0u);
                }
                EXPECT_EQ(raysOutOfSteps(engine.targets()), 0);
            }
        }
    }
}

TEST_P(CurvedEarth, TheHorizonHidesThePeaksFoot) {
    // One sample of 6000 m stands in the sea, 240 km to the north of the eye at 1000 m.
    constexpr int64_t kAway = 300;
    constexpr double kHeightOfEye = 1000, kDistance = kAway * kSpacing - kSpacing / 2;
    const ComputedDataset peak(
        [](int64_t column, int64_t row) { return column == 512 && row == 512 - kAway ? 6000.0f : 0.0f; }, kSamples,
        kSpacing);
    Engine engine(peak.source(), shaders_, options(), kWidth, kHeight);
    const Camera camera = cameraAt({0, 0, kHeightOfEye}, 0, -0.2, 2);
    const double metresPerPixel = kDistance / viewOf(camera, kWidth, kHeight).focalPixels();
    // The rays of the pixels right of the middle go through the peak.
    Camera placed = camera;
    placed.position += glm::dvec3(kMiddle.x + (kSpacing - metresPerPixel) / 2, kMiddle.y - kSpacing / 2, 0);
    engine.drawFrame(placed, true);
    // Beyond its own horizon a line of sight that touches the sea is at the square of the rest of the way.
    const double beyond = kDistance - std::sqrt(2 * kMeanRadius * kHeightOfEye);
    const double hidden = beyond * beyond / (2 * kMeanRadius);
    const Grid<glm::vec4> hits = engine.targets().readHits();
    const Grid<uint32_t> nodes = engine.targets().readNodes();
    double lowest = 1e9, highest = 0;
    for (int64_t row = 0; row < kHeight; ++row) {
        const uint32_t node = nodes.at(kWidth / 2, row);
        if (node == 0) continue;
        const glm::dvec3 at = engine.worldFromHit(engine.nodes()[node - 1], hits.at(kWidth / 2, row));
        if (at.z < 1) continue;  // the sea
        EXPECT_NEAR(at.y - placed.position.y, kDistance, kSpacing);
        lowest = std::min(lowest, at.z);
        highest = std::max(highest, at.z);
    }
    EXPECT_GT(hidden, 1000) << "else there is little to see";
    // A row of pixels; and patches lean over a sample's width, 800 m, on which the hidden part changes by 16 m.
    EXPECT_NEAR(lowest, hidden, metresPerPixel + 16);
    EXPECT_NEAR(highest, 6000, metresPerPixel + 16);
}

TEST_P(CurvedEarth, NoSkyShowsWhereARayReachesTheDeepestGround) {
    const ComputedDataset hills(1024, kSpacing, 3);
    const DatasetMetadata& metadata = hills.source().metadata();
    const GroundRect ground = hills.ground();
    Engine engine(hills.source(), shaders_, options(kStandardRefraction), kWidth, kHeight);
    int64_t reached = 0, bent = 0;
    for (const double height : {200.0, 3000.0, 12000.0})
        for (int heading = 0; heading < 360; heading += 45) {
            engine.drawFrame(cameraAt({kMiddle, metadata.maxHeight + height}, heading, -3, 20), true);
            const View& view = engine.view();
            const auto nodes = engine.targets().readNodes();
            const auto hits = engine.targets().readHits();
            for (int64_t row = 0; row < kHeight; ++row)
                for (int64_t column = 0; column < kWidth; ++column) {
                    const glm::dvec3 ray =
                        view.direction(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
                    const double bend = view.earth->drop(ray.x, ray.y), fall = view.eye.z - metadata.minHeight + 1;
                    const double root = ray.z * ray.z - 4 * bend * fall;
                    if (root < 0 || ray.z >= 0) continue;
                    const double t = 2 * fall / (std::sqrt(root) - ray.z);
                    const glm::dvec3 place = view.at(ray, t);
                    if (place.x < ground.west || place.x > ground.east || place.y < ground.south ||
                        place.y > ground.north)
                        continue;
                    ++reached;
                    bent += bend * t * t > 1000 ? 1 : 0;
                    ASSERT_NE(nodes.at(column, row), 0u) << height << ' ' << heading << ' ' << column << ' ' << row;
                    ASSERT_LT(hits.at(column, row).w, t);
                }
            EXPECT_EQ(raysOutOfSteps(engine.targets()), 0);
        }
    EXPECT_GT(reached, 100000);
    EXPECT_GT(bent, 10000);
}

TEST_P(CurvedEarth, AHoleIsSeenThroughAsOnAFlatEarth) {
    const ComputedDataset holed(
        [](int64_t column, int64_t row) {
            return column >= 200 && column < 300 && row >= 200 && row < 300 ? kNoHeight : 50.0f;
        },
        {512, 512}, 1);
    // At an angle, so that most rays pass the ground through the hole and run on below the cells behind it.
    const Camera camera = cameraAt({1250, 4650, 250}, 0, -60, 50);
    Engine bent(holed.source(), shaders_, options(), kWidth, kHeight);
    bent.drawFrame(camera, true);
    EngineOptions flatOptions = options();
    flatOptions.earth.shape = EarthShape::flat;
    Engine flat(holed.source(), shaders_, flatOptions, kWidth, kHeight);
    flat.drawFrame(camera, true);
    const auto bentNodes = bent.targets().readNodes(), flatNodes = flat.targets().readNodes();
    int64_t sky = 0, different = 0;
    for (size_t pixel = 0; pixel < flatNodes.cells().size(); ++pixel) {
        sky += flatNodes.cells()[pixel] == 0 ? 1 : 0;
        different += (flatNodes.cells()[pixel] == 0) != (bentNodes.cells()[pixel] == 0) ? 1 : 0;
    }
    EXPECT_GT(sky, 2000);
    EXPECT_LE(different, 20) << "the earth drops by 5 mm here: along the hole's rim a few pixels may change";
}

TEST_P(CurvedEarth, TheGroundIsClosedFromBelow) {
    const ComputedDataset slab([](int64_t, int64_t) { return 300.0f; }, {1024, 1024}, 20);
    EngineOptions options = this->options(-200);  // an earth of 32 km radius, so that rays come up again after sinking
    Engine engine(slab.source(), shaders_, options, kWidth, kHeight);
    const GroundRect ground = slab.ground();
    int64_t rising = 0, sinkingFirst = 0;
    for (const double pitch : {40.0, 0.0, -3.0}) {
        engine.drawFrame(cameraAt({ground.west + 3000, ground.south + 4000, 150}, 60, pitch, 30), true);
        const View& view = engine.view();
        const auto nodes = engine.targets().readNodes();
        const auto hits = engine.targets().readHits();
        for (int64_t row = 0; row < kHeight; ++row)
            for (int64_t column = 0; column < kWidth; ++column) {
                const glm::dvec3 ray =
                    view.direction(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
                const double bend = view.earth->drop(ray.x, ray.y);
                const double t = (std::sqrt(ray.z * ray.z + 4 * bend * 150) - ray.z) / (2 * bend);
                const glm::dvec3 place = view.at(ray, t);
                if (place.x < ground.west + 20 || place.x > ground.east - 20 || place.y < ground.south + 20 ||
                    place.y > ground.north - 20)
                    continue;
                ++rising;
                sinkingFirst += ray.z < 0 ? 1 : 0;
                const uint32_t node = nodes.at(column, row);
                ASSERT_NE(node, 0u) << pitch << ' ' << column << ' ' << row;
                const glm::dvec3 at = engine.worldFromHit(engine.nodes()[node - 1], hits.at(column, row));
                ASSERT_NEAR(at.z, 300, 1) << pitch << ' ' << column << ' ' << row;
            }
    }
    EXPECT_GT(rising, 10000);
    EXPECT_GT(sinkingFirst, 1000);
}

std::string parameterName(const testing::TestParamInfo<CurvedEarth::ParamType>& info) {
    return std::string(std::get<Launch>(info.param) == Launch::raster ? "Raster" : "Compute") +
           (std::get<Surface>(info.param) == Surface::columns ? "Columns" : "Bilinear");
}

INSTANTIATE_TEST_SUITE_P(Both, CurvedEarth,
                         testing::Combine(testing::Values(Launch::raster, Launch::compute),
                                          testing::Values(Surface::columns, Surface::bilinear)),
                         parameterName);

}  // namespace
}  // namespace terray
