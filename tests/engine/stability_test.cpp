// The stability suite: what it takes for wrong, and a fast part of its cases.

#include "client/bench/stability.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "client/bench/bench.h"
#include "client/bench/measured_frame.h"
#include "client/bench/stability_scenes.h"
#include "client/render/gl_context.h"
#include "common/reference/dataset_heights.h"
#include "tests/common/temporary_directory.h"

namespace terray {
namespace {

/// A ground of one tile, a picture from above it, and what is true.
class StabilityBoundTest : public testing::Test {
  protected:
    StabilityBoundTest() {
        view_.eye = {400256, 5199744, 200};
        view_.forward = {0, 0.8, -0.6};
        view_.up = {0, 0.6, 0.8};
        view_.width = view_.height = 64;
    }
    [[nodiscard]] std::optional<double> met(const glm::ivec2& pixel) const {
        return truth_.meet(view_, view_.direction(pixel.x + 0.5, pixel.y + 0.5));
    }
    [[nodiscard]] DrawnPixel at(const glm::ivec2& pixel, double depth) const {
        const glm::dvec3 direction = view_.direction(pixel.x + 0.5, pixel.y + 0.5);
        return {.ground = true, .depth = depth, .place = view_.at(direction, depth)};
    }
    [[nodiscard]] RayVerdict judged(const glm::ivec2& pixel, const DrawnPixel& drawn, Precision precision) const {
        const BoundTerms terms{.precision = precision, .coordinates = 5.2e6};
        return judgeRay(truth_, view_, pixel, drawn, stabilityBound(view_, terms), -1000);
    }

    FormulaDataset ground_{{.west = 400000, .north = 5200000}, hillAt};
    DatasetHeights heights_{ground_.metadata(),
                            [this](const TileId& id) { return ground_.read(TileLayer::heights, id); }};
    GroundCaster truth_{heights_, ground_.metadata().tiling, floorBelow(ground_.metadata())};
    View view_;
};

TEST_F(StabilityBoundTest, TakesTheTruthAndRoundingsForRight) {
    for (int n = 0; n < 64; ++n) {
        const glm::ivec2 pixel(n, 63);
        const double depth = met(pixel).value();
        EXPECT_EQ(judged(pixel, at(pixel, depth), Precision::full), RayVerdict::right);
        EXPECT_EQ(judged(pixel, at(pixel, depth * (1 + 0x1p-22)), Precision::single), RayVerdict::right);
    }
}

TEST_F(StabilityBoundTest, TakesEveryOtherEndForWrong) {
    const glm::ivec2 pixel(30, 60);
    const double depth = met(pixel).value();
    EXPECT_EQ(judged(pixel, at(pixel, depth * 0.9999), Precision::single), RayVerdict::misplaced);
    EXPECT_EQ(judged(pixel, at(pixel, depth * 1.0001), Precision::single), RayVerdict::misplaced);
    EXPECT_EQ(judged(pixel, at(pixel, depth * (1 + 0x1p-22)), Precision::full), RayVerdict::misplaced)
        << "what is a rounding in float is none in double";
    EXPECT_EQ(judged(pixel, {}, Precision::single), RayVerdict::seeThrough);
    DrawnPixel off = at(pixel, depth);
    off.place.x += 0.01;
    EXPECT_EQ(judged(pixel, off, Precision::single), RayVerdict::misplaced);
    off.place.x = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(judged(pixel, off, Precision::single), RayVerdict::notANumber);
    view_.forward = {0, 0.8, 0.6};
    EXPECT_EQ(judged(pixel, at(pixel, 100), Precision::single), RayVerdict::coversSky);
    EXPECT_EQ(judged(pixel, {}, Precision::single), RayVerdict::right);
}

TEST(StabilityCases, HaveNamesOfTheirOwn) {
    std::set<std::string> names;
    for (const StabilityCase& of : stabilityCases()) EXPECT_TRUE(names.insert(of.name).second) << of.name;
    EXPECT_GT(names.size(), 50U);
}

/// The part of the suite that runs with the tests: those that have failed once, and one of each group.
constexpr std::array kFast{"directions/vertical",
                           "flat/rays in its plane",
                           "earth/of 300 m radius",
                           "extent/one sample",
                           "scale/ground 0.1 mm away",
                           "picture/of 1 pixel",
                           "flat/100 million codes below the eye",
                           "origin/on the surface",
                           "steep/a cliff along a tile's border"};

TEST(StabilityCases, TheFastOnesAreMet) {
    HeadlessContext context({.debug = true});
    const ShaderLibrary shaders;
    size_t run = 0;
    for (const StabilityCase& of : stabilityCases()) {
        if (std::find(kFast.begin(), kFast.end(), of.name) == kFast.end()) continue;
        ++run;
        for (const StabilityRow& row : runStabilityCase(of, shaders, {}))
            EXPECT_TRUE(row.met()) << row.name << ", " << name(row.caster) << (row.columns ? ", columns: " : ": ")
                                   << row.wrong << " wrong, " << row.outOfSteps << " out of steps";
    }
    EXPECT_EQ(run, kFast.size()) << "a case has another name";
    EXPECT_EQ(context.takeDebugMessages(), "");
}

TEST(StabilityProgram, WritesATableAndFailsWhenARayEndsWrongly) {
    const test::TemporaryDirectory directory;
    const std::string out = (directory.path() / "run").string();
    EXPECT_EQ(runBench({"stability", "--case", "picture/of 1 pixel", "--out", out}), ExitCode::ok);
    for (const char* file : {"stability.csv", "summary.json", "manifest.json"})
        EXPECT_TRUE(std::filesystem::exists(directory.path() / "run" / file)) << file;
    EXPECT_EQ(runBench({"stability", "--case", "extent/one row", "--method", "linear:least=2,most=2,halvings=0"}),
              ExitCode::verification);
    try {
        (void)runBench({"stability", "--case", "no such thing"});
        FAIL() << "a case that does not exist was taken";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::usage);
    }
}

}  // namespace
}  // namespace terray
