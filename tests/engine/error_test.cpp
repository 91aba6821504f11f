// terray-bench error: what it measures on ground that is known, and what it writes.

#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "client/bench/bench.h"
#include "client/bench/error_measurement.h"
#include "client/bench/requantised_source.h"
#include "common/json.h"
#include "tests/common/temporary_directory.h"
#include "tests/support/analytic_dataset.h"

namespace terray {
namespace {

std::string textOf(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

class ErrorTest : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        shared_ = std::make_unique<test::TemporaryDirectory>();
        std::filesystem::create_directory(*shared_ / "dataset");
        AnalyticDataset({.finestLevel = 2}).write(*shared_ / "dataset");
        (void)runBench({"tour", dataset(), "--seconds", "2", "--out", tour()});
    }
    static void TearDownTestSuite() { shared_.reset(); }
    static std::string dataset() { return (*shared_ / "dataset").string(); }
    static std::string tour() { return (*shared_ / "tour.json").string(); }
    static constexpr const char* kSize = "64x36";

    ExitCode measure(const std::vector<std::string>& more) {
        std::vector<std::string> all{
            "error",  dataset(),  "--flight", tour(),      "--size", kSize,   "--frames",
            "3",      "--pixels", "0",        "--repeats", "2",      "--out", (own_ / "run").string(),
            "--force"};
        all.insert(all.end(), more.begin(), more.end());
        try {
            return runBench(all);
        } catch (const Error& error) {
            message_ = error.what();
            return error.code();
        }
    }
    /// The columns of a setting.
    [[nodiscard]] Json setting(const std::string& name) const {
        const Json summary = Json::parse(textOf(own_ / "run" / "summary.json")).value();
        for (const Json& one : summary.find("settings")->array())
            if (one.stringAt("name").value() == name) return *one.find("columns");
        ADD_FAILURE() << "no setting " << name;
        return {};
    }
    static double at(const Json& columns, const char* column, const char* statistic) {
        return columns.find(column)->numberAt(statistic).value();
    }

    static inline std::unique_ptr<test::TemporaryDirectory> shared_;
    test::TemporaryDirectory own_;
    std::string message_;
};

TEST_F(ErrorTest, BilinearGroundOfTheFinestLevelIsTheTruthToThousandthsOfAPixel) {
    ASSERT_EQ(measure({"--surface", "bilinear", "--tolerance", "0.001"}), ExitCode::ok) << message_;
    const Json columns = setting("as given");
    EXPECT_LT(at(columns, "error_px", "p99"), 0.002);
    EXPECT_LT(at(columns, "error_px", "max"), 0.05);
    EXPECT_LT(at(columns, "depth_relative", "median"), 1e-5);
    // A grazing ray may be told either way: a few of 6912.
    EXPECT_LE(at(columns, "see_through", "sum"), 2);
    EXPECT_LE(at(columns, "covers_sky", "sum"), 2);
    EXPECT_EQ(at(columns, "lacking", "sum"), 0);
}

TEST_F(ErrorTest, HoldsOnACurvedEarthAndExaggerated) {
    for (const std::vector<std::string>& scene : {std::vector<std::string>{"--earth", "curved", "--refraction", "-5"},
                                                  std::vector<std::string>{"--exaggeration", "3"}}) {
        std::vector<std::string> all{"--surface", "bilinear", "--tolerance", "0.001"};
        all.insert(all.end(), scene.begin(), scene.end());
        ASSERT_EQ(measure(all), ExitCode::ok) << message_;
        EXPECT_LT(at(setting("as given"), "error_px", "p99"), 0.003) << scene[0];
        EXPECT_LE(at(setting("as given"), "see_through", "sum"), 2) << scene[0];
    }
}

TEST_F(ErrorTest, SeesWhatColumnsAndTolerancesCost) {
    ASSERT_EQ(measure({"--sweep", "tolerance"}), ExitCode::ok) << message_;
    const Json fine = setting("bilinear 0.25 px"), coarse = setting("bilinear 8 px");
    EXPECT_GT(at(coarse, "error_px", "median"), 10 * at(fine, "error_px", "median"));
    EXPECT_GT(at(coarse, "error_px", "p99"), at(fine, "error_px", "p99"));
    EXPECT_LE(at(coarse, "error_px", "p95"), 8);
    EXPECT_GT(at(setting("columns 0.25 px"), "error_px", "p99"), 3 * at(fine, "error_px", "p99"));
    EXPECT_LT(at(coarse, "nodes", "sum"), at(fine, "nodes", "sum"));
}

TEST_F(ErrorTest, TheMethodSweepMeasuresEachOnce) {
    ASSERT_EQ(measure({"--sweep", "method"}), ExitCode::ok) << message_;
    for (const MethodEntry& entry : kMethods) EXPECT_EQ(at(setting(std::string(entry.name)), "lacking", "sum"), 0);
    EXPECT_EQ(at(setting("march"), "error_px", "max"), at(setting("pyramid"), "error_px", "max")) << "both are exact";
}

TEST_F(ErrorTest, NothingPopsAtTheFinestLevelAndDetailPopsInAtCoarseOnes) {
    const std::vector<std::string> finest{"--surface", "bilinear", "--tolerance", "0.25", "--fps", "20"};
    ASSERT_EQ(measure(finest), ExitCode::ok) << message_;
    EXPECT_EQ(at(setting("as given"), "popping", "mean"), 0);
    EXPECT_EQ(at(setting("as given"), "popping", "max"), 0);
    // A tour of 2 s at 1 frame a second: between frames whole tiles change their level.
    ASSERT_EQ(measure({"--surface", "bilinear", "--tolerance", "30", "--fps", "1"}), ExitCode::ok) << message_;
    EXPECT_NE(at(setting("as given"), "popping", "max"), 0);
    EXPECT_EQ(measure({"--fps", "0"}), ExitCode::usage);
}

TEST_F(ErrorTest, CoarserStepsOfHeightsCostWhatTheyRoundAway) {
    ASSERT_EQ(measure({"--sweep", "quantum"}), ExitCode::ok) << message_;
    const auto worst = [&](const std::string& name) { return at(setting(name), "error_px", "p99"); };
    EXPECT_GT(worst("quantum 5 m"), 2 * worst("quantum 1 m"));
    EXPECT_GT(worst("quantum 1 m"), 2 * worst("quantum 0.2 m"));
    EXPECT_GT(worst("quantum 0.2 m"), worst("quantum as stored"));
}

TEST(RequantisedSource, RoundsEachHeightToTheStepAndKeepsRecordsTrue) {
    const AnalyticDataset fine({.finestLevel = 2});
    const double quantum = 0.7;
    const RequantisedSource coarse(fine, quantum);
    EXPECT_EQ(coarse.metadata().quantum, quantum);
    EXPECT_NE(coarse.contentHash(), fine.contentHash());
    for (const TileId id : {TileId{0, 0, 0}, TileId{1, 1, 0}, TileId{2, 3, 2}}) {
        const HeightTile before = decodeHeightTile(*fine.read(TileLayer::heights, id), id).value();
        const HeightTile after = decodeHeightTile(*coarse.read(TileLayer::heights, id), id).value();
        EXPECT_EQ(after.encoding.metresPerCode(), quantum);
        const auto old = before.codes.cells();
        double worst = 0;
        for (size_t n = 0; n < old.size(); ++n) {
            const uint16_t code = after.codes.cells()[n];
            ASSERT_EQ(code == kNoSurface, old[n] == kNoSurface);
            if (code == kNoSurface) continue;
            worst = std::max(worst, std::abs(before.encoding.height(old[n]) - after.encoding.height(code)));
        }
        EXPECT_LE(worst, quantum / 2 + 1e-9);
        EXPECT_GT(worst, 0.45 * quantum);
        EXPECT_GE(after.record.error, before.record.error + quantum / 2);
        EXPECT_EQ(after.record, measureRecord(after.codes, after.encoding, after.record.error));
        for (uint32_t quadrant = 0; quadrant < 4 && id.level < 2; ++quadrant) {
            const TileId child = id.child(quadrant);
            const HeightTile below = decodeHeightTile(*coarse.read(TileLayer::heights, child), child).value();
            EXPECT_EQ(after.children[quadrant], below.record);
        }
    }
}

TEST_F(ErrorTest, WritesItsTableAsDocumented) {
    ASSERT_EQ(measure({"--sweep", "launch"}), ExitCode::ok) << message_;
    std::stringstream table(textOf(own_ / "run" / "errors.csv"));
    std::string header, first, second;
    std::getline(table, header);
    std::getline(table, first);
    std::getline(table, second);
    const auto commas = [](const std::string& line) { return std::count(line.begin(), line.end(), ','); };
    EXPECT_EQ(commas(first), commas(header));
    EXPECT_TRUE(second.starts_with("\"compute\",\"compute\","));
    const std::string documentation = textOf(std::filesystem::path(TERRAY_SOURCE_DIR) / "client" / "README.md");
    std::stringstream names(header);
    for (std::string name; std::getline(names, name, ',');) {
        const size_t end = name.rfind('_');
        const bool known = documentation.find("`" + name + "`") != std::string::npos ||
                           documentation.find("`" + name.substr(0, end) + "_*`") != std::string::npos;
        EXPECT_TRUE(known) << "client/README.md lacks " << name;
    }
    const Json manifest = Json::parse(textOf(own_ / "run" / "manifest.json")).value();
    EXPECT_EQ(manifest.find("protocol")->numberAt("width").value(), 64);
    EXPECT_EQ(manifest.stringAt("sweep").value(), "launch");
    const std::string run = (own_ / "run").string();
    EXPECT_EQ(runBench({"compare", run, run, "--fail-if", "error_px.p99>1x,lacking.sum>0"}), ExitCode::ok);
    EXPECT_EQ(runBench({"compare", run, run, "--fail-if", "error_px.p99>0.99x"}), ExitCode::threshold);
}

#if TERRAY_WITH_OUTPUT
TEST_F(ErrorTest, WritesMapsAndRemovesThemByForce) {
    ASSERT_EQ(measure({"--maps"}), ExitCode::ok) << message_;
    EXPECT_TRUE(std::filesystem::exists(own_ / "run" / "maps" / "map_as_given_00002.png"));
    EXPECT_TRUE(std::filesystem::exists(own_ / "run" / "maps" / "map_as_given_00002.exr"));
    ASSERT_EQ(measure({}), ExitCode::ok) << message_;
    EXPECT_FALSE(std::filesystem::exists(own_ / "run" / "maps"));
}
#endif

TEST_F(ErrorTest, BadUseIsRefused) {
    EXPECT_EQ(measure({"--sweep", "colour"}), ExitCode::usage);
    EXPECT_NE(message_.find("expected one of tolerance|"), std::string::npos) << message_;
    EXPECT_EQ(measure({"--supersampling", "9"}), ExitCode::usage);
    std::ofstream(own_ / "edits.json")
        << R"({"format":"terray-edits","version":1,"edits":[{"kind":"crater","at":{"x_m":0,"y_m":0},"radius_m":9,"depth_m":1}]})";
    EXPECT_EQ(measure({"--edits", (own_ / "edits.json").string()}), ExitCode::usage) << "the truth is not edited";
    EXPECT_FALSE(std::filesystem::exists(own_ / "run"));
}

TEST(Averaged, TakesTheMeanOfLight) {
    Grid<Rgba> picture({4, 2}, {0, 0, 0, 255});
    picture.at(0, 0) = picture.at(1, 1) = {255, 255, 255, 255};
    for (int x = 2; x < 4; ++x)
        for (int y = 0; y < 2; ++y) picture.at(x, y) = {77, 10, 200, 255};
    const Grid<Rgba> half = averaged(picture.view(), 2);
    EXPECT_EQ(half.at(0, 0), (Rgba{188, 188, 188, 255}));  // half of white's light
    EXPECT_EQ(half.at(1, 0), (Rgba{77, 10, 200, 255}));
}

}  // namespace
}  // namespace terray
