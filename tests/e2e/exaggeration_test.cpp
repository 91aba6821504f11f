// Heights drawn multiplied by F make the picture of ground that is F times as high; at any moment, without loading
// anew.

#include <cmath>
#include <memory>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/e2e/scene.h"

namespace terray {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;
constexpr GridSize kSamples = {1500, 1200};
constexpr double kSpacing = 4;

/// Hills of 240 m over 1 to 2 km, rough by 3 m, from -40 m on.
double hills(int64_t column, int64_t row) {
    const double x = static_cast<double>(column), y = static_cast<double>(row);
    return 80 + 70 * std::sin(x / 61) * std::cos(y / 83) + 50 * std::sin((x + 2 * y) / 97) +
           static_cast<double>((column * 7919 + row * 104729) % 13) / 4;
}

/// The hills times a factor, stored so finely that codes are the same for all factors.
std::unique_ptr<ComputedDataset> hillsTimes(double factor) {
    return std::make_unique<ComputedDataset>(
        [factor](int64_t column, int64_t row) { return static_cast<float>(factor * hills(column, row)); }, kSamples,
        kSpacing, 0.01 * factor);
}

Camera timesHigher(Camera camera, double factor) {
    camera.position.z *= factor;
    return camera;
}

/// From far above, from within the hills, from straight above.
std::vector<Camera> cameras() {
    return {cameraAt({2500, 1000, 700}, 30, -35, 60), cameraAt({3000, 2500, 190}, 200, -4, 60),
            cameraAt({4000, 3000, 900}, 100, -90)};
}

class Exaggeration : public testing::Test {
  protected:
    HeadlessContext context_{HeadlessContext::Options{.debug = true}};
    ShaderLibrary shaders_;
    void TearDown() override { EXPECT_EQ(context_.takeDebugMessages(), ""); }

    std::unique_ptr<Engine> engine(const ComputedDataset& dataset, double exaggeration,
                                   Surface surface = Surface::automatic, Launch launch = Launch::raster) {
        EngineOptions options = inspectedOptions(surface);
        options.exaggeration = exaggeration;
        options.render.launch = launch;
        return std::make_unique<Engine>(dataset.source(), shaders_, options, kWidth, kHeight);
    }
};

/// Pixels that show ground, if two engines drew the same to the last bit; else -1.
int64_t sameGround(const Engine& a, const Engine& b) {
    const auto nodes = a.targets().readNodes();
    const auto hits = a.targets().readHits(), others = b.targets().readHits();
    if (nodes != b.targets().readNodes() || a.targets().readNormals() != b.targets().readNormals() ||
        a.targets().readSrgb() != b.targets().readSrgb())
        return -1;
    int64_t ground = 0;
    for (size_t n = 0; n < nodes.cells().size(); ++n) {
        if (nodes.cells()[n] == 0) continue;
        if (hits.cells()[n] != others.cells()[n]) return -1;
        ++ground;
    }
    return ground;
}

constexpr int64_t kThird = kWidth * kHeight / 3;

TEST_F(Exaggeration, ByAPowerOfTwoIsTheHigherGroundToTheLastBit) {
    const auto ground = hillsTimes(1);
    for (const double factor : {4.0, 0.25}) {
        const auto higher = hillsTimes(factor);
        for (const Surface surface : {Surface::columns, Surface::bilinear})
            for (const Launch launch : {Launch::raster, Launch::compute}) {
                const auto exaggerating = engine(*ground, factor, surface, launch);
                const auto plain = engine(*higher, 1, surface, launch);
                for (const Camera& camera : cameras()) {
                    exaggerating->drawFrame(camera, true);
                    plain->drawFrame(timesHigher(camera, factor), true);
                    EXPECT_EQ(exaggerating->nodes().size(), plain->nodes().size());
                    EXPECT_GT(sameGround(*exaggerating, *plain), kThird) << factor;
                }
            }
    }
}

TEST_F(Exaggeration, ByAnyFactorIsTheHigherGroundButForRounding) {
    const auto ground = hillsTimes(1);
    for (const double factor : {5.0, 0.3}) {
        const auto higher = hillsTimes(factor);
        const auto exaggerating = engine(*ground, factor), plain = engine(*higher, 1);
        for (const Camera& camera : cameras()) {
            exaggerating->drawFrame(camera, true);
            plain->drawFrame(timesHigher(camera, factor), true);
            ASSERT_EQ(exaggerating->nodes().size(), plain->nodes().size());
            const auto hits = exaggerating->targets().readHits(), expected = plain->targets().readHits();
            const auto normals = exaggerating->targets().readNormals(), others = plain->targets().readNormals();
            const auto nodes = exaggerating->targets().readNodes(), otherNodes = plain->targets().readNodes();
            int64_t ridges = 0, hitCount = 0;
            for (int64_t y = 0; y < kHeight; ++y)
                for (int64_t x = 0; x < kWidth; ++x) {
                    const double t = hits.at(x, y).w, wanted = expected.at(x, y).w;
                    // Where a ray grazes a ridge, the last bit decides what it hits.
                    if (nodes.at(x, y) != otherNodes.at(x, y) || std::abs(t - wanted) > 1e-3 * wanted) {
                        ++ridges;
                        continue;
                    }
                    if (nodes.at(x, y) == 0) continue;
                    ++hitCount;
                    EXPECT_NEAR(t, wanted, 1e-4 * wanted);  // heights that tie in rounding differ by 5 cm
                    EXPECT_LT(glm::length(normals.at(x, y) - others.at(x, y)), 0.01f);
                }
            EXPECT_LT(ridges, 20);
            EXPECT_GT(hitCount, kThird);
        }
    }
}

TEST_F(Exaggeration, HitsLieOnTheRayAndNameHeightsOfTheDataset) {
    const auto ground = hillsTimes(1);
    const auto drawing = engine(*ground, 3, Surface::bilinear);
    drawing->drawFrame(cameras()[0], true);
    const auto hits = drawing->targets().readHits();
    const auto nodes = drawing->targets().readNodes();
    const View& view = drawing->view();
    int64_t looked = 0;
    for (int64_t y = 0; y < kHeight; y += 5)
        for (int64_t x = 0; x < kWidth; x += 5) {
            if (nodes.at(x, y) == 0) continue;
            const glm::dvec3 place = drawing->worldFromHit(drawing->nodes()[nodes.at(x, y) - 1], hits.at(x, y));
            if (place.y < ground->ground().south + 1) continue;  // the cut at the edge
            const glm::dvec3 onRay =
                view.at(view.direction(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5), hits.at(x, y).w);
            EXPECT_NEAR(glm::length(glm::dvec2(place - onRay)), 0, 0.1);
            EXPECT_NEAR(3 * place.z, onRay.z, 0.1);
            // Between samples 4 m apart on slopes up to 0.6 and 3 m rough.
            EXPECT_NEAR(
                place.z,
                hills(std::lround((place.x - 1000) / kSpacing - 0.5), std::lround((5000 - place.y) / kSpacing - 0.5)),
                8);
            ++looked;
        }
    EXPECT_GT(looked, 200);
}

TEST_F(Exaggeration, ChangesFromFrameToFrameWithoutLoadingAnyTileAgain) {
    const auto ground = hillsTimes(1);
    const Camera camera = cameras()[0];
    const auto live = engine(*ground, 1), plain = engine(*ground, 1), fivefold = engine(*ground, 5);
    plain->drawFrame(camera, true);
    fivefold->drawFrame(camera, true);
    live->setExaggeration(5);
    live->drawFrame(camera, true);  // errors are larger: all that is ever needed is loaded now
    EXPECT_GT(sameGround(*live, *fivefold), kThird);
    for (const double factor : {1.0, 5.0, 1.0}) {
        live->setExaggeration(factor);
        const FrameReport report = live->drawFrame(camera, true);
        EXPECT_EQ(report.uploadedTiles, 0u);
        EXPECT_GT(sameGround(*live, factor == 1 ? *plain : *fivefold), kThird) << factor;
    }
    EXPECT_EQ(sameGround(*live, *fivefold), -1);
}

}  // namespace
}  // namespace terray
