// The photo lies where it belongs, at every level, through every mip and at every angle; both ways of filtering agree.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/e2e/scene.h"

namespace terray {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;
/// 1300 x 1100 samples of 2 m from (1000, 5000), so the last tiles are part empty.
constexpr GridSize kSamples = {1300, 1100};
constexpr double kWest = 1000, kNorth = 5000, kWide = 2600, kHigh = 2200;

float flat(int64_t, int64_t) {
    return 100;
}

/// Red rises from 40 to 220 to the east, green to the south; blue changes in fields of 100 m, by 20.
Rgba ramps(double x, double y) {
    const auto level = [](double share) {
        return static_cast<uint8_t>(40 + std::lround(180 * std::clamp(share, 0.0, 1.0)));
    };
    const bool odd = (std::lround(std::floor(x / 100)) + std::lround(std::floor(y / 100))) % 2 != 0;
    return {level((x - kWest) / kWide), level((kNorth - y) / kHigh), static_cast<uint8_t>(odd ? 120 : 100), 255};
}

// BC1 rounds a channel to 5 or 6 bits and to four steps between two ends: about 5 of 255, so up to 0.04 in linear light
// at the bright end. Flipped, swapped or shifted tiles are off by far more; the edges below look closer.
constexpr double kTolerance = 0.045;

double linear(double srgb) {
    return std::pow((srgb / 255 + 0.055) / 1.055, 2.4);
}

class Photo : public testing::Test {
  protected:
    HeadlessContext context_{HeadlessContext::Options{.debug = true}};
    ShaderLibrary shaders_;
    void TearDown() override { EXPECT_EQ(context_.takeDebugMessages(), ""); }

    /// Colours of a view against the ramps at each hit. The light on flat ground is one factor a channel, found from
    /// the picture's own median, so that the test does not repeat the shader's constants.
    void expectRamps(const ComputedDataset& dataset, const Camera& camera, EngineOptions options, bool fits = true) {
        options.colour = ColourFormat::linearFloat;
        Engine engine(dataset.source(), shaders_, options, kWidth, kHeight);
        const FrameReport report = engine.drawFrame(camera, true);
        EXPECT_EQ(report.wanted, 0u);
        EXPECT_EQ(report.coarsening == Coarsening(), fits) << "photos finer than memory holds";
        const auto colours = engine.targets().readLinear();
        const auto hits = engine.targets().readHits();
        const auto nodes = engine.targets().readNodes();
        for (int channel = 0; channel < 2; ++channel) {
            std::vector<std::pair<double, double>> seenAndExpected;
            for (int64_t y = 0; y < kHeight; ++y)
                for (int64_t x = 0; x < kWidth; ++x) {
                    const uint32_t node = nodes.at(x, y);
                    if (node == 0) continue;
                    const glm::dvec3 at = engine.worldFromHit(engine.nodes()[node - 1], hits.at(x, y));
                    // Away from the edge, where the photo ends within a footprint.
                    if (at.x < kWest + 150 || at.x > kWest + kWide - 150) continue;
                    if (at.y > kNorth - 150 || at.y < kNorth - kHigh + 150) continue;
                    seenAndExpected.emplace_back(colours.at(x, y)[channel],
                                                 linear(ramps(at.x, at.y)[static_cast<size_t>(channel)]));
                }
            ASSERT_GT(seenAndExpected.size(), 1000u);
            std::vector<double> light;
            for (const auto& [seen, expected] : seenAndExpected) light.push_back(seen / expected);
            std::nth_element(light.begin(), light.begin() + static_cast<ptrdiff_t>(light.size() / 2), light.end());
            const double factor = light[light.size() / 2];
            for (const auto& [seen, expected] : seenAndExpected)
                ASSERT_NEAR(seen / factor, expected, kTolerance) << channel;
        }
    }
};

TEST_F(Photo, LiesWhereItBelongsFromEveryDistance) {
    const ComputedDataset dataset(flat, kSamples, 2, ramps, 3);  // 1 m texels over 2 m samples
    const double middleX = kWest + kWide / 2;
    const double middleY = kNorth - kHigh / 2;
    for (const double height : {20.0, 300.0, 1500.0, 6000.0})
        expectRamps(dataset, cameraAt({middleX, middleY, 100 + height}, 30, -90, 45), inspectedOptions());
}

TEST_F(Photo, LiesWhereItBelongsAtEveryAngle) {
    const ComputedDataset dataset(flat, kSamples, 2, ramps, 3);
    for (const double pitch : {-60.0, -20.0, -5.0})
        for (const double heading : {0.0, 137.0, 250.0}) {
            const double back = 400;
            const double turn = radiansFromDegrees(heading).value();
            const glm::dvec3 eye(kWest + kWide / 2 - back * std::sin(turn), kNorth - kHigh / 2 - back * std::cos(turn),
                                 180);
            expectRamps(dataset, cameraAt(eye, heading, pitch, 50), inspectedOptions());
        }
}

TEST_F(Photo, MayBeCoarserThanTheHeights) {
    const ComputedDataset dataset(flat, kSamples, 2, ramps, 1);  // 4 m texels
    expectRamps(dataset, cameraAt({2300, 3900, 500}, 10, -40, 50), inspectedOptions());
}

TEST_F(Photo, PhotosCoarsenedToFitMemoryLieWhereTheyBelong) {
    const ComputedDataset dataset(flat, kSamples, 2, ramps, 3);
    EngineOptions options = inspectedOptions();
    options.gpuImageryBytes = 2 * imageryChainBytes();  // the root and one more
    expectRamps(dataset, cameraAt({2300, 3900, 400}, 10, -50, 50), options, false);
}

TEST_F(Photo, EdgesLieWithinHalfATexelOnEveryLevel) {
    // Dark to the west of x = 2302 and to the north of y = 3898.
    const auto quarters = [](double x, double y) {
        return Rgba{static_cast<uint8_t>(x < 2302 ? 60 : 200), static_cast<uint8_t>(y > 3898 ? 60 : 200), 100, 255};
    };
    const ComputedDataset dataset(flat, kSamples, 2, quarters, 3);
    EngineOptions options = inspectedOptions();
    options.colour = ColourFormat::linearFloat;
    std::vector<uint32_t> levels;
    for (const double height : {60.0, 400.0, 1000.0, 3000.0}) {
        Engine engine(dataset.source(), shaders_, options, kWidth, kHeight);
        engine.drawFrame(cameraAt({2300, 3900, 100 + height}, 0, -90, 45), true);
        const auto colours = engine.targets().readLinear();
        const auto hits = engine.targets().readHits();
        const auto nodes = engine.targets().readNodes();
        const auto worldAt = [&](int64_t x, int64_t y) {
            return engine.worldFromHit(engine.nodes()[nodes.at(x, y) - 1], hits.at(x, y));
        };
        const uint32_t level = engine.nodes()[nodes.at(kWidth / 2, kHeight / 2) - 1].imageryTile->level;
        levels.push_back(level);
        const double pixel = worldAt(kWidth / 2, 3 * kHeight / 4).x - worldAt(kWidth / 2 - 1, 3 * kHeight / 4).x;
        const double bound = 0.5 * dataset.source().metadata().tiling.spacing(level) + 0.1 * pixel;
        // Where a channel passes the middle of its two ends, between two pixels, along a row and along a column.
        for (int64_t along = kWidth / 2 - 10; along < kWidth / 2 + 10; ++along) {
            const auto red = [&](int64_t x) { return colours.at(x, 3 * kHeight / 4).r; };
            const auto green = [&](int64_t y) { return colours.at(kWidth / 4, y).g; };
            const float middleRed = 0.5f * (red(kWidth / 2 - 10) + red(kWidth / 2 + 10));
            const float middleGreen = 0.5f * (green(kHeight / 2 - 10) + green(kHeight / 2 + 10));
            if (red(along) < middleRed && red(along + 1) >= middleRed) {
                const double share = (middleRed - red(along)) / (red(along + 1) - red(along));
                EXPECT_NEAR(worldAt(along, 3 * kHeight / 4).x + share * pixel, 2302, bound) << height;
            }
            const int64_t row = along - kWidth / 2 + kHeight / 2;
            if (green(row) < middleGreen && green(row + 1) >= middleGreen) {
                const double share = (middleGreen - green(row)) / (green(row + 1) - green(row));
                EXPECT_NEAR(worldAt(kWidth / 4, row).y - share * pixel, 3898, bound) << height;
            }
        }
        EXPECT_LT(colours.at(kWidth / 2 - 10, 3 * kHeight / 4).r, colours.at(kWidth / 2 + 10, 3 * kHeight / 4).r);
        EXPECT_LT(colours.at(kWidth / 4, kHeight / 2 - 10).g, colours.at(kWidth / 4, kHeight / 2 + 10).g);
    }
    EXPECT_GT(levels.front(), levels.back()) << "several levels must be seen";
}

TEST_F(Photo, OverACurvedEarthFootprintsGrowTowardsItsHorizon) {
    // Stripes of 10 m across the view, on an earth that is 32 km in radius to the eye: its horizon is 8 km away. There
    // the ground is seen edge-on although rays leave the eye at 14 degrees: filtered for those the stripes would show.
    constexpr double kPeriod = 20;
    const auto stripes = [](double, double y) {
        const auto grey = static_cast<uint8_t>(std::fmod(y + 1e6, kPeriod) < kPeriod / 2 ? 220 : 40);
        return Rgba{grey, grey, grey, 255};
    };
    const ComputedDataset dataset(flat, {1024, 1024}, 20, stripes, 3);
    EngineOptions options = inspectedOptions();
    options.colour = ColourFormat::linearFloat;
    options.earth = {.shape = EarthShape::curved, .refraction = -200};
    Engine engine(dataset.source(), shaders_, options, kWidth, kHeight);
    engine.drawFrame(cameraAt({11000, 5000 - 15000, 1100}, 0, -14.8, 4), true);
    const auto colours = engine.targets().readLinear();
    const auto hits = engine.targets().readHits();
    const auto nodes = engine.targets().readNodes();
    const View& view = engine.view();
    double sum = 0, squares = 0, count = 0;
    for (int64_t y = 0; y < kHeight; ++y)
        for (int64_t x = 0; x < kWidth; ++x) {
            if (nodes.at(x, y) == 0) continue;
            // The angle at which the bent ray meets the level ground, and the footprint that makes.
            const glm::dvec3 ray = view.direction(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
            const double t = hits.at(x, y).w;
            const double grazing = -(ray.z + 2 * view.earth->drop(ray.x, ray.y) * t) / std::hypot(ray.x, ray.y);
            if (t / view.focalPixels() / grazing < 2 * kPeriod) continue;
            sum += colours.at(x, y).g;
            squares += std::pow(colours.at(x, y).g, 2);
            ++count;
        }
    ASSERT_GT(count, 3000);
    const double mean = sum / count;
    EXPECT_LT(std::sqrt(squares / count - mean * mean), 0.1 * mean) << "unfiltered it is the mean";
}

TEST_F(Photo, ProbesFilterLikeTheTextureUnits) {
    const ComputedDataset dataset(flat, kSamples, 2, ramps, 3);
    const auto draw = [&](PhotoFilter filter) {
        EngineOptions options = inspectedOptions();
        options.render.photoFilter = filter;
        Engine engine(dataset.source(), shaders_, options, kWidth, kHeight);
        engine.drawFrame(cameraAt({2300, 3400, 200}, 20, -10, 50), true);
        return engine.targets().readSrgb();
    };
    const auto probes = draw(PhotoFilter::probes);
    const auto hardware = draw(PhotoFilter::hardware);
    double sum = 0;
    for (size_t i = 0; i < probes.cells().size(); ++i)
        for (size_t channel = 0; channel < 3; ++channel)
            sum += std::abs(int{probes.cells()[i][channel]} - int{hardware.cells()[i][channel]});
    EXPECT_LT(sum / static_cast<double>(3 * probes.cells().size()), 1.0) << "mean difference, of 255";
}

}  // namespace
}  // namespace terray
