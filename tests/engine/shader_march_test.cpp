// The march of the shaders on the CPU: in float it shows what the GPU shows, in double what is true.

#include "client/bench/shader_march.h"

#include <gtest/gtest.h>

#include "client/bench/measured_frame.h"
#include "client/render/gl_context.h"
#include "client/stream/flight.h"
#include "common/reference/dataset_heights.h"
#include "common/reference/pixel_pattern.h"
#include "tests/stream/fake_dataset.h"
#include "tests/support/analytic_dataset.h"

namespace terray {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 64;

/// How far two pictures of the same pixels are apart.
struct Apart {
    size_t ground = 0;
    size_t kind = 0;      ///< ground in one, sky in the other
    size_t farther = 0;   ///< by more than 1e-4 of the depth: past another ridge, or another side of a column
    double relative = 0;  ///< the greatest of the others
};

Apart apart(const std::vector<DrawnPixel>& a, const std::vector<DrawnPixel>& b) {
    Apart result;
    for (size_t n = 0; n < a.size(); ++n) {
        result.kind += a[n].ground != b[n].ground ? 1 : 0;
        if (!a[n].ground || !b[n].ground) continue;
        ++result.ground;
        const double relative = std::abs(a[n].depth - b[n].depth) / b[n].depth;
        if (relative > 1e-4) {
            ++result.farther;
        } else {
            result.relative = std::max(result.relative, relative);
        }
    }
    return result;
}

class ShaderMarchTest : public testing::Test {
  protected:
    /// Draws nine frames of a tour and calls use(engine) after each.
    template <class Use>
    void fly(const TileSource& source, const EngineOptions& options, Use use) {
        Engine engine(source, shaders_, options, kWidth, kHeight);
        const Flight tour = standardTour(source, 8);
        for (int second = 0; second <= 8; ++second) {
            (void)drawWhole(engine, tour.at(second));
            use(engine);
        }
    }
    void TearDown() override { EXPECT_EQ(context_.takeDebugMessages(), ""); }

    HeadlessContext context_{{.debug = true}};
    ShaderLibrary shaders_;
    AnalyticDataset heights_{{.finestLevel = 2}};
    std::vector<glm::ivec2> pixels_ = pixelPattern(kWidth, kHeight, SIZE_MAX);
};

TEST_F(ShaderMarchTest, InFloatShowsWhatTheGpuShows) {
    for (const Surface surface : {Surface::columns, Surface::bilinear, Surface::automatic})
        for (const EarthShape shape : {EarthShape::flat, EarthShape::curved}) {
            EngineOptions options;
            options.render.surface = surface;
            options.earth.shape = shape;
            ShaderMarch march(heights_);
            size_t ground = 0;
            size_t odd = 0;
            fly(heights_, options, [&](const Engine& engine) {
                const auto cpu = march.draw(engine.nodes(), engine.view(), surface, Precision::single, pixels_);
                const Apart found = apart(drawnPixels(engine, pixels_), cpu);
                // A sum of three products, rounded otherwise by the GPU's compiler: some last places of t.
                EXPECT_LT(found.relative, 1e-5);
                ground += found.ground;
                odd += found.kind + found.farther;
            });
            EXPECT_GT(ground, 9U * kWidth * kHeight / 4);
            EXPECT_LT(odd, ground / 2000) << "rays that graze an edge may pass it on the other side";
        }
}

TEST_F(ShaderMarchTest, InDoubleMeetsTheTruthWhereFloatOnlyComesNear) {
    const DatasetHeights heights(heights_.metadata(),
                                 [&](const TileId& id) { return heights_.read(TileLayer::heights, id); });
    const GroundCaster truth(heights, heights_.metadata().tiling, floorBelow(heights_.metadata()));
    for (const EarthShape shape : {EarthShape::flat, EarthShape::curved}) {
        EngineOptions options = finestOf({}, 1e-3);
        options.earth.shape = shape;
        ShaderMarch march(heights_);
        ErrorTotals single, full;
        fly(heights_, options, [&](const Engine& engine) {
            const auto measure = [&](Precision precision) {
                return pixelErrors(truth, engine.view(), pixels_,
                                   march.draw(engine.nodes(), engine.view(), Surface::bilinear, precision, pixels_));
            };
            single.add(measure(Precision::single));
            full.add(measure(Precision::full));
        });
        EXPECT_GT(full.errorPixels.size(), 9U * kWidth * kHeight / 4);
        EXPECT_EQ(full.seeThrough + full.coversSky, 0U);
        EXPECT_LT(spreadOf(full.errorPixels).p99, 1e-9);
        EXPECT_LT(spreadOf(full.errorPixels).max, 1e-4) << "along grazing rays";
        EXPECT_GT(spreadOf(single.errorPixels).median, 100 * spreadOf(full.errorPixels).median);
        EXPECT_LT(spreadOf(single.errorPixels).p99, 0.01);
    }
}

TEST_F(ShaderMarchTest, HolesStayOpenInAllPrecisions) {
    // Every third sample of every third row is missing, and a square of 40.
    const auto dataset = test::buildDataset(
        [](int64_t x, int64_t y) {
            const bool hole = (x % 3 == 0 && y % 3 == 0) || (x / 40 == 5 && y / 40 == 5);
            return hole ? std::numeric_limits<double>::quiet_NaN() : 40 * std::sin(0.03 * static_cast<double>(x + y));
        },
        {.samples = {600, 700}});
    const test::FakeSource source(dataset);
    EngineOptions options = finestOf({}, 1e-3);
    options.earth.shape = EarthShape::flat;
    ShaderMarch march(source);
    size_t odd = 0, ground = 0;
    fly(source, options, [&](const Engine& engine) {
        const auto full = march.draw(engine.nodes(), engine.view(), Surface::bilinear, Precision::full, pixels_);
        const Apart found = apart(drawnPixels(engine, pixels_), full);
        ground += found.ground;
        odd += found.kind + found.farther;
    });
    EXPECT_GT(ground, 1000U);
    EXPECT_LT(odd, ground / 200) << "rays that graze a hole's rim";
}

}  // namespace
}  // namespace terray
