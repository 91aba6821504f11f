// Contour lines and cell edges lie where they should to a pixel, and nowhere else.

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "tests/support/shaded_picture.h"

namespace terray {
namespace {

constexpr double kInterval = 50;  // metres; fine lines only count, so that heights need no multiple of five of it

class ShadingLines : public testing::Test {
  protected:
    HeadlessContext context_{HeadlessContext::Options{.debug = true}};
    ShaderLibrary shaders_;
    static inline const AnalyticDataset dataset_{{.finestLevel = 2}};  // keeps the tiles it has made
    void TearDown() override { EXPECT_EQ(context_.takeDebugMessages(), ""); }

    ShadedPicture draw(Shading shading, const EngineOptions& options, const Camera& camera) {
        return ShadedPicture(shaders_, dataset_, shading, options, camera);
    }
};

/// A value on the ground whose whole numbers are lines, at a pixel.
using Value = std::function<double(int64_t x, int64_t y)>;

struct Found {
    int64_t crossed = 0;  ///< pairs of neighbours between which a line passes
    int64_t missing = 0;  ///< of these, without ink on either
    int64_t clear = 0;    ///< pixels with no line within two pixels
    int64_t stained = 0;  ///< of these, with ink
};

/// How far from the colour of bare ground a pixel is.
double ink(const ShadedPicture& picture, int64_t x, int64_t y, const Encoded& ground) {
    return distance(picture.tint(x, y), ground);
}

/// Looks where neighbours (two pixels around) are ground of one node without an edge in view between them, and where
/// lines are farther apart than eight pixels, which is where none is faded.
Found look(const ShadedPicture& picture, const Value& value, const Encoded& ground) {
    constexpr int kAround = 2;
    constexpr double kInk = 20, kClean = 2;
    Found found;
    for (int64_t y = kAround; y < picture.height() - kAround; ++y)
        for (int64_t x = kAround; x < picture.width() - kAround; ++x) {
            if (!picture.isGround(x, y)) continue;
            bool usable = true, near = false;
            for (int64_t dy = -kAround; dy <= kAround; ++dy)
                for (int64_t dx = -kAround; dx <= kAround; ++dx) {
                    if (!usable) continue;
                    usable = picture.isGround(x + dx, y + dy) && &picture.node(x + dx, y + dy) == &picture.node(x, y) &&
                             std::abs(value(x + dx, y + dy) - value(x, y)) < (kAround + 1) / 8.0;
                    if (usable) near |= std::floor(value(x + dx, y + dy)) != std::floor(value(x, y));
                }
            if (!usable) continue;
            if (!near) {
                ++found.clear;
                found.stained += ink(picture, x, y, ground) > kClean;
            }
            for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{0, 1}}) {
                if (std::floor(value(x + dx, y + dy)) == std::floor(value(x, y))) continue;
                ++found.crossed;
                found.missing += std::max(ink(picture, x, y, ground), ink(picture, x + dx, y + dy, ground)) < kInk;
            }
        }
    return found;
}

TEST_F(ShadingLines, ContoursLieWhereTheHeightIsAMultipleOfTheIntervalWhateverTheExaggeration) {
    for (const double factor : {1.0, 2.0})
        for (const double pitch : {-90.0, -45.0}) {
            EngineOptions options;
            options.exaggeration = factor;
            options.render.shading.contourInterval = Metres(kInterval);
            options.render.surface = Surface::bilinear;
            const ShadedPicture picture =
                draw(Shading::contours, options, shadedCamera({403000, 5195000, 2300}, 30, pitch));
            const Found found = look(
                picture, [&](int64_t x, int64_t y) { return picture.place(x, y).z / kInterval; }, legend(0xe6e0d0));
            EXPECT_GT(found.crossed, 300) << factor << " " << pitch;
            // Lines are as wide as the smooth slope says, which near ridges and saddles is not that of the patch.
            EXPECT_LE(found.missing, found.crossed / 200) << factor << " " << pitch;
            EXPECT_GT(found.clear, 1000) << factor << " " << pitch;
            EXPECT_LE(found.stained, found.clear / 200) << factor << " " << pitch;
        }
}

TEST_F(ShadingLines, EveryFifthContourIsStronger) {
    EngineOptions options;
    options.render.shading.contourInterval = Metres(kInterval);
    const ShadedPicture picture = draw(Shading::contours, options, shadedCamera({403000, 5195000, 2300}, 30, -60));
    double fine = 0, strong = 0;
    for (int64_t y = 0; y < picture.height(); ++y)
        for (int64_t x = 0; x < picture.width(); ++x) {
            if (!picture.isGround(x, y)) continue;
            const auto line = std::llround(picture.place(x, y).z / kInterval);
            double& most = line % 5 == 0 ? strong : fine;
            most = std::max(most, ink(picture, x, y, legend(0xe6e0d0)));
        }
    EXPECT_GT(fine, 60);
    EXPECT_GT(strong, fine + 40);
}

TEST_F(ShadingLines, ContoursTakeAnIntervalFromTheDataset) {
    const ShadedPicture picture = draw(Shading::contours, {}, shadedCamera({403000, 5195000, 2300}, 30, -60));
    EXPECT_NEAR(picture.engine().shading().contourInterval.value(), 20, 1e-9);  // heights from 600 to 1400 m
    EXPECT_EQ(description(picture.engine().shading()), "contours, every 20 m, stronger every 100 m");
}

TEST_F(ShadingLines, TheGridFollowsTheEdgesOfSampleCells) {
    const Encoded ground = legend(0xb9b4a6);
    const glm::dvec2 place(403000, 5195000);
    const double height = AnalyticDataset::heightAt(place.x, place.y) + 40;  // cells of 4 m span about 10 pixels
    const ShadedPicture picture = draw(Shading::grid, {}, shadedCamera(glm::dvec3(place, height), 0, -90));
    for (const bool south : {false, true}) {
        const Found found = look(
            picture, [&](int64_t x, int64_t y) { return south ? picture.hit(x, y).y : picture.hit(x, y).x; }, ground);
        EXPECT_GT(found.crossed, 500);
        EXPECT_EQ(found.missing, 0);
    }
    int64_t inside = 0, stained = 0;
    for (int64_t y = 0; y < picture.height(); ++y)
        for (int64_t x = 0; x < picture.width(); ++x) {
            const auto away = [](double v) { return std::abs(v - std::round(v)); };
            if (std::min(away(picture.hit(x, y).x), away(picture.hit(x, y).y)) < 0.35) continue;
            ++inside;
            stained += ink(picture, x, y, ground) > 2;
        }
    EXPECT_GT(inside, 1000);
    EXPECT_EQ(stained, 0);
}

TEST_F(ShadingLines, LinesFadeWhereTheyWouldMerge) {
    EngineOptions options;
    options.render.shading.contourInterval = Metres(0.05);
    const ShadedPicture picture = draw(Shading::contours, options, shadedCamera({403000, 5195000, 2300}, 30, -60));
    int64_t ground = 0, stained = 0;
    for (int64_t y = 0; y < picture.height(); ++y)
        for (int64_t x = 0; x < picture.width(); ++x) {
            if (!picture.isGround(x, y)) continue;
            ++ground;
            stained += ink(picture, x, y, legend(0xe6e0d0)) > 2;
        }
    EXPECT_GT(ground, 10000);
    EXPECT_LT(stained, ground / 50) << "only level places keep their lines";
}

}  // namespace
}  // namespace terray
