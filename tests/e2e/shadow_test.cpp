// Shadows fall where they must, from tiles in the picture and outside it, and nowhere else: no acne, no leaks at level
// jumps, none along tile borders; the same by both launches.

#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "client/engine/engine_options.h"
#include "tests/e2e/scene.h"

namespace terray {
namespace {

constexpr int kWidth = 128;
constexpr int kHeight = 96;

/// Heights are stored to a centimetre, so slopes near a ray's start are known to a few of them.
constexpr double kQuantum = 0.02;

/// The finest samples as a bilinear surface, in double, straight from the function that the dataset was built from.
class FineSurface {
  public:
    FineSurface(HeightFunction heights, GridSize size, double spacing, const GroundRect& ground)
        : heights_(std::move(heights)), size_(size), spacing_(spacing), ground_(ground) {}

    /// Least clearance of a ray to the sun above the surface, not counting what is nearer than half a sample; 0 for
    /// rays that dip below the surface there, or leave it, and prove nothing.
    [[nodiscard]] double clearance(const glm::dvec3& from, const glm::dvec3& sun) const {
        const double sample = spacing_ / std::max(std::hypot(sun.x, sun.y), 1e-3);
        const auto above = [&](double s) {
            const glm::dvec3 at = from + s * sun;
            return at.z - heightAt(at);
        };
        // Finely at first: the ray may cross a crease there.
        for (int i = 1; i < 100; ++i)
            if (above(i * 0.005 * sample) < (i < 20 ? 0 : kQuantum)) return 0;
        double least = 1e9;
        for (double s = 0.5 * sample; inside(from + s * sun); s += 0.1 * sample) least = std::min(least, above(s));
        return least < 1e9 ? least : 0;
    }
    [[nodiscard]] double heightAt(const glm::dvec3& at) const {
        const double x = (at.x - ground_.west) / spacing_ - 0.5, y = (ground_.north - at.y) / spacing_ - 0.5;
        const auto column = static_cast<int64_t>(std::floor(x)), row = static_cast<int64_t>(std::floor(y));
        const double u = x - static_cast<double>(column), v = y - static_cast<double>(row);
        return (1 - v) * ((1 - u) * sample(column, row) + u * sample(column + 1, row)) +
               v * ((1 - u) * sample(column, row + 1) + u * sample(column + 1, row + 1));
    }
    /// Half a sample from the edge or more.
    [[nodiscard]] bool inside(const glm::dvec3& at) const {
        const double margin = spacing_ / 2;
        return at.x > ground_.west + margin && at.x < ground_.east - margin && at.y > ground_.south + margin &&
               at.y < ground_.north - margin && at.z < 1e5;
    }

  private:
    [[nodiscard]] double sample(int64_t column, int64_t row) const {
        return heights_(std::clamp<int64_t>(column, 0, size_.width - 1), std::clamp<int64_t>(row, 0, size_.height - 1));
    }
    HeightFunction heights_;
    GridSize size_;
    double spacing_;
    GroundRect ground_;
};

EngineOptions shadowOptions(double azimuth, double elevation, Launch launch) {
    EngineOptions options = inspectedOptions();
    options.render.launch = launch;
    options.render.sunDirection = sunDirection(std::to_string(azimuth) + "," + std::to_string(elevation));
    options.render.shadows = ShadowOptions{};
    return options;
}

/// Calls visit(x, y, world position of the hit, part of the sun) for every pixel that shows ground.
template <class Visit>
void forEachHit(const Engine& engine, Visit visit) {
    const auto nodes = engine.targets().readNodes();
    const auto hits = engine.targets().readHits();
    const auto light = engine.targets().readSunLight();
    for (int64_t y = 0; y < nodes.height(); ++y)
        for (int64_t x = 0; x < nodes.width(); ++x)
            if (const uint32_t node = nodes.at(x, y); node != 0)
                visit(x, y, engine.worldFromHit(engine.nodes()[node - 1], hits.at(x, y)), light.at(x, y));
}

/// Whether a place lies on the ground, `margin` metres from its edge or more.
bool within(const GroundRect& ground, const glm::dvec3& at, double margin) {
    return at.x > ground.west + margin && at.x < ground.east - margin && at.y > ground.south + margin &&
           at.y < ground.north - margin;
}

class Shadows : public testing::TestWithParam<Launch> {
  protected:
    HeadlessContext context_{HeadlessContext::Options{.debug = true}};
    ShaderLibrary shaders_;
    void TearDown() override { EXPECT_EQ(context_.takeDebugMessages(), ""); }
};

INSTANTIATE_TEST_SUITE_P(Launches, Shadows, testing::Values(Launch::raster, Launch::compute),
                         [](const auto& launch) { return std::string(name(launch.param)); });

/// A wall 200 m high from north to south across column 500, on flat ground; its shadow falls beyond the tile's border
/// at column 512, which is 2024 m.
float wall(int64_t column, int64_t) {
    return column >= 497 && column < 504 ? 200.F : 0.F;
}
/// The bilinear surface falls off behind the last sample's centre.
constexpr double kWallsEnd = 1000 + 2 * 503.5;

TEST_P(Shadows, AWallsShadowEndsWhereTheSunsRaysSay) {
    const ComputedDataset dataset(wall, {1024, 1024}, 2);
    // Sun in the west at atan(1/2): 200 m throw 400 m to the east.
    Engine engine(dataset.source(), shaders_, shadowOptions(270, 26.565051, GetParam()), kWidth, kHeight);
    engine.drawFrame(cameraAt({kWallsEnd + 200, 4000, 900}, 0, -90, 60), true);
    int64_t lit = 0, dark = 0;
    forEachHit(engine, [&](int64_t, int64_t, const glm::dvec3& at, float part) {
        if (at.x < kWallsEnd + 4) return;
        const double beyond = at.x - (kWallsEnd + 400);
        if (std::abs(beyond) < 3) return;  // the edge, within a sample and a half
        (beyond > 0 ? lit : dark) += 1;
        EXPECT_EQ(part, beyond > 0 ? 1.F : 0.F) << at.x;
    });
    EXPECT_GT(lit, 500);
    EXPECT_GT(dark, 500);
}

TEST_P(Shadows, FallIntoThePictureFromTilesOutsideIt) {
    const ComputedDataset dataset(wall, {1024, 1024}, 2);
    Engine engine(dataset.source(), shaders_, shadowOptions(270, 26.565051, GetParam()), kWidth, kHeight);
    // Straight down at the strip from 150 m to 350 m behind the wall: nothing of the wall is in view.
    const FrameReport report = engine.drawFrame(cameraAt({kWallsEnd + 250, 4000, 150}, 0, -90, 40), true);
    forEachHit(engine, [&](int64_t, int64_t, const glm::dvec3& at, float part) {
        ASSERT_GT(at.x, 2024);
        EXPECT_EQ(part, 0.F) << at.x;
    });
    EXPECT_GT(report.casters, 0u);
}

/// Smooth waves no steeper than 0.25 = tan(14 degrees).
float waves(int64_t column, int64_t row) {
    return static_cast<float>(40 * std::sin(static_cast<double>(column) * 0.025) *
                              std::cos(static_cast<double>(row) * 0.021)) +
           0.1F * static_cast<float>(row);
}

TEST_P(Shadows, GroundThatNowhereHidesTheSunHasNoAcne) {
    const ComputedDataset dataset(waves, {2048, 2048}, 5);
    std::mt19937 random(3);
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    int64_t ground = 0, dark = 0, jumps = 0;
    // Starved budgets put coarse tiles beside fine ones; a sun of 25 degrees is steeper than every slope and every chord.
    for (const uint64_t slots : {5, 12, 30}) {
        for (const double azimuth : {0.0, 45.0, 135.0, 222.0, 270.0}) {
            EngineOptions options = shadowOptions(azimuth, 25, GetParam());
            options.gpuHeightBytes = slots * 720'000;
            options.selection.tolerance = Pixels(0.02);
            Engine engine(dataset.source(), shaders_, options, kWidth, kHeight);
            for (int i = 0; i < 6; ++i) {
                const glm::dvec3 eye(1000 + uniform(1000, 9000), 5000 - uniform(1000, 9000), uniform(250, 2500));
                engine.drawFrame(cameraAt(eye, uniform(0, 360), uniform(-60, -3), 60), true);
                const auto nodes = engine.targets().readNodes();
                forEachHit(engine, [&](int64_t x, int64_t y, const glm::dvec3& at, float part) {
                    if (!within(dataset.ground(), at, 10)) return;  // the sides of the block of ground
                    ++ground;
                    dark += part < 1;
                    if (x == 0 || nodes.at(x - 1, y) == 0) return;
                    jumps += engine.nodes()[nodes.at(x - 1, y) - 1].heightTile.level !=
                             engine.nodes()[nodes.at(x, y) - 1].heightTile.level;
                });
            }
        }
    }
    EXPECT_EQ(dark, 0) << "of " << ground;
    EXPECT_GT(ground, 300'000);
    EXPECT_GT(jumps, 500) << "level jumps must be in view";
}

TEST_P(Shadows, AgreeWithRaysInDoubleThroughTheFinestSamples) {
    const auto rough = [](int64_t column, int64_t row) {
        const auto x = static_cast<double>(column), y = static_cast<double>(row);
        return static_cast<float>(90 * std::sin(x * 0.031 + 1) * std::sin(y * 0.027) +
                                  35 * std::sin(x * 0.11 + y * 0.07) + 9 * std::sin(y * 0.31 - x * 0.23));
    };
    const ComputedDataset dataset(rough, {1024, 1024}, 4);
    const FineSurface truth(rough, {1024, 1024}, 4, dataset.ground());
    for (const double azimuth : {10.0, 100.0, 250.0}) {
        EngineOptions options = shadowOptions(azimuth, 18, GetParam());
        options.selection.tolerance = Pixels(0.01);  // the finest tiles everywhere
        Engine engine(dataset.source(), shaders_, options, 64, 48);
        engine.drawFrame(cameraAt({1000 + 2000, 5000 - 2500, 700}, 40, -40, 60), true);
        const glm::dvec3 sun = glm::normalize(options.render.sunDirection);
        int64_t sure = 0, wrong = 0, dark = 0;
        forEachHit(engine, [&](int64_t, int64_t, const glm::dvec3& at, float part) {
            if (!truth.inside(at)) return;
            const double clearance = truth.clearance({at.x, at.y, truth.heightAt(at)}, sun);
            if (std::abs(clearance) < 0.3) return;  // quantum of heights and oracle's steps
            ++sure;
            dark += part == 0;
            wrong += part != (clearance > 0 ? 1.F : 0.F);
        });
        EXPECT_EQ(wrong, 0) << "of " << sure << ", azimuth " << azimuth;
        EXPECT_GT(sure, 64 * 48 / 4);
        EXPECT_GT(dark, sure / 20);
        EXPECT_LT(dark, sure * 19 / 20);
    }
}

TEST_P(Shadows, ASoftSunsPenumbraIsAsWideAsItsDisc) {
    const ComputedDataset dataset(wall, {1024, 1024}, 2);
    EngineOptions options = shadowOptions(270, 45, GetParam());
    const double diameter = 4 * 3.14159265358979 / 180;
    options.render.shadows = ShadowOptions{.sunDiameter = diameter, .rays = 32};
    Engine engine(dataset.source(), shaders_, options, kWidth, kHeight);
    engine.drawFrame(cameraAt({kWallsEnd + 200, 4000, 120}, 0, -90, 40), true);
    // 200 m away the disc's edges are seen at 43 and 47 degrees: from 200 / tan(47) to 200 / tan(43).
    const double begins = kWallsEnd + 200 / std::tan((45 + 2) * 3.14159265358979 / 180);
    const double ends = kWallsEnd + 200 / std::tan((45 - 2) * 3.14159265358979 / 180);
    double pixels = 0, sum = 0;
    forEachHit(engine, [&](int64_t, int64_t, const glm::dvec3& at, float part) {
        if (at.x < begins - 3) {
            EXPECT_EQ(part, 0.F) << at.x;
        }
        if (at.x > ends + 3) {
            EXPECT_EQ(part, 1.F) << at.x;
        }
        if (std::abs(at.x - (kWallsEnd + 200)) < 1) {
            ++pixels;
            sum += part;
        }
    });
    EXPECT_GT(pixels, 50);
    EXPECT_NEAR(sum / pixels, 0.5, 0.05) << "half of the disc is seen along the shadow of its middle";
}

TEST_P(Shadows, BelowTheHorizonTheSunNeedsNoRays) {
    const ComputedDataset dataset(wall, {1024, 1024}, 2);
    Engine engine(dataset.source(), shaders_, shadowOptions(270, -5, GetParam()), kWidth, kHeight);
    const FrameReport report = engine.drawFrame(cameraAt({2200, 4000, 900}, 0, -90, 60), true);
    EXPECT_EQ(report.casters, 0u);
    EXPECT_EQ(report.gpuMs[static_cast<size_t>(GpuPass::shadow)], 0);
}

TEST(ShadowLaunches, DrawTheSameShadows) {
    const HeadlessContext context;
    const ShaderLibrary shaders_;
    const ComputedDataset dataset(2048, 5, 31);
    const EngineOptions first = shadowOptions(300, 12, Launch::raster),
                        second = shadowOptions(300, 12, Launch::compute);
    Engine raster(dataset.source(), shaders_, first, 157, 93), compute(dataset.source(), shaders_, second, 157, 93);
    const double top = dataset.source().metadata().maxHeight;
    for (const double pitch : {-60.0, -20.0, -5.0}) {
        const Camera camera = cameraAt({6000, 0, top + 200}, 200, pitch, 60);
        raster.drawFrame(camera, true);
        compute.drawFrame(camera, true);
        const Grid<float> light = raster.targets().readSunLight();
        EXPECT_TRUE(light == compute.targets().readSunLight());
        EXPECT_TRUE(raster.targets().readShadowSteps() == compute.targets().readShadowSteps());
        expectSameColours(raster.targets(), compute.targets());
        EXPECT_GT(std::ranges::count(light.cells(), 0.F), 100);
    }
}

}  // namespace
}  // namespace terray
