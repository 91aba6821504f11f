#include <chrono>
#include <cmath>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "client/bench/bench.h"
#include "client/bench/frame_table.h"
#include "client/stream/flight_recorder.h"
#include "tests/common/temporary_directory.h"
#include "tests/support/analytic_dataset.h"

namespace terray {
namespace {

using test::TemporaryDirectory;

std::string textOf(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> split(const std::string& line, char separator) {
    std::vector<std::string> parts;
    std::stringstream stream(line);
    for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
    if (!line.empty() && line.back() == separator) parts.emplace_back();
    return parts;
}

/// Column by column.
std::map<std::string, std::vector<std::string>> tableOf(const std::filesystem::path& path) {
    const std::vector<std::string> lines = split(textOf(path), '\n');
    std::map<std::string, std::vector<std::string>> table;
    if (lines.empty()) return table;
    const std::vector<std::string> names = split(lines[0], ',');
    for (size_t line = 1; line < lines.size(); ++line) {
        const std::vector<std::string> fields = split(lines[line], ',');
        if (lines[line].empty()) continue;
        EXPECT_EQ(fields.size(), names.size());
        for (size_t n = 0; n < std::min(names.size(), fields.size()); ++n) table[names[n]].push_back(fields[n]);
    }
    return table;
}

class ReplayTest : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        shared_ = std::make_unique<TemporaryDirectory>();
        std::filesystem::create_directory(*shared_ / "dataset");
        AnalyticDataset({.finestLevel = 1, .imageryLevel = 1}).write(*shared_ / "dataset");
    }
    static void TearDownTestSuite() { shared_.reset(); }

    static std::string dataset() { return (*shared_ / "dataset").string(); }
    std::string in(const std::string& name) const { return (own_ / name).string(); }
    static ExitCode bench(const std::vector<std::string>& arguments) {
        try {
            return runBench(arguments);
        } catch (const Error& error) {
            return error.code();
        }
    }
    std::string tour() {
        if (!std::filesystem::exists(in("tour.json"))) {
            EXPECT_EQ(bench({"tour", dataset(), "--seconds", "2", "--out", in("tour.json")}), ExitCode::ok);
        }
        return in("tour.json");
    }
    /// Nine frames a run.
    ExitCode replay(const std::string& name, const std::vector<std::string>& more = {}) {
        std::vector<std::string> all{"replay", dataset(), "--flight", tour(),  "--size",
                                     "64x48",  "--fps",   "4",        "--out", in(name)};
        all.insert(all.end(), more.begin(), more.end());
        return bench(all);
    }

    static inline std::unique_ptr<TemporaryDirectory> shared_;
    TemporaryDirectory own_;
};

TEST_F(ReplayTest, WritesALineAFrameUnderTheDocumentedHeader) {
    ASSERT_EQ(replay("run", {"--wait-for-tiles"}), ExitCode::ok);
    const std::vector<std::string> lines = split(textOf(own_ / "run" / "frames.csv"), '\n');
    ASSERT_EQ(lines.size(), 11u);  // the last one ends, too
    EXPECT_EQ(lines[0], FrameTable::header());
    const auto table = tableOf(own_ / "run" / "frames.csv");
    for (size_t n = 0; n < 9; ++n) {
        EXPECT_EQ(table.at("frame")[n], std::to_string(n));
        EXPECT_NEAR(std::stod(table.at("seconds")[n]), static_cast<double>(n) / 4, 1e-6);
        EXPECT_EQ(table.at("rays")[n], std::to_string(64 * 48));
        EXPECT_EQ(table.at("rays_out_of_steps")[n], "0");
        EXPECT_EQ(std::stoi(table.at("rays_hit")[n]) + std::stoi(table.at("rays_sky")[n]), 64 * 48);
        EXPECT_GT(std::stod(table.at("gpu_march_ms")[n]), 0);
        EXPECT_EQ(table.at("wanted")[n], "0");
    }
    const std::string documentation = textOf(std::filesystem::path(TERRAY_SOURCE_DIR) / "client" / "README.md");
    for (const std::string& column : split(FrameTable::header(), ','))
        EXPECT_NE(documentation.find("`" + column + "`"), std::string::npos) << "client/README.md lacks " << column;
}

TEST_F(ReplayTest, CountsEachMarchedRayOnceInTheHistogramOfSteps) {
    ASSERT_EQ(replay("run", {"--wait-for-tiles"}), ExitCode::ok);
    const auto frames = tableOf(own_ / "run" / "frames.csv");
    const auto steps = tableOf(own_ / "run" / "steps.csv");
    double rays = 0, most = 0, marched = 0, mostOfFrames = 0;
    for (size_t n = 0; n < steps.at("steps").size(); ++n) {
        rays += std::stod(steps.at("rays")[n]);
        most = std::max(most, std::stod(steps.at("steps")[n]));
    }
    for (size_t n = 0; n < 9; ++n) {
        marched += std::stod(frames.at("rays_marched")[n]);
        mostOfFrames = std::max(mostOfFrames, std::stod(frames.at("steps_max")[n]));
    }
    EXPECT_GT(rays, 0);
    EXPECT_EQ(rays, marched);
    EXPECT_EQ(most, mostOfFrames);
    ASSERT_EQ(replay("run", {"--force", "--no-statistics"}), ExitCode::ok);
    EXPECT_FALSE(std::filesystem::exists(own_ / "run" / "steps.csv")) << "a histogram of an earlier run";
}

TEST_F(ReplayTest, TwoRunsDifferOnlyInTimes) {
    ASSERT_EQ(replay("a", {"--wait-for-tiles", "--launch", "raster"}), ExitCode::ok);
    ASSERT_EQ(replay("b", {"--wait-for-tiles", "--launch", "raster"}), ExitCode::ok);
    const auto a = tableOf(own_ / "a" / "frames.csv");
    const auto b = tableOf(own_ / "b" / "frames.csv");
    for (const auto& [name, values] : a) {
        if (name.ends_with("_ms")) continue;
        EXPECT_EQ(values, b.at(name)) << name;
    }
}

TEST_F(ReplayTest, AtKeysDrawsEachRecordedPoseAtItsTime) {
    FlightRecorder recorder;
    const Flight standard = loadFlight(tour());
    for (const double seconds : {0.0, 0.31, 0.32, 1.1, 2.0}) recorder.record(70 + seconds, standard.at(seconds));
    const Flight recorded = recorder.flight("hills", "test");
    saveFlight(recorded, in("recorded.json"), nullptr);
    ASSERT_EQ(bench({"replay", dataset(), "--flight", in("recorded.json"), "--size", "64x48", "--out", in("run"),
                     "--at-keys", "--wait-for-tiles"}),
              ExitCode::ok);
    const auto table = tableOf(own_ / "run" / "frames.csv");
    ASSERT_EQ(table.at("seconds").size(), recorded.keys.size());
    for (size_t n = 0; n < recorded.keys.size(); ++n) {
        const FlightKey& key = recorded.keys[n];
        EXPECT_NEAR(std::stod(table.at("seconds")[n]), key.seconds, 1e-6);
        EXPECT_NEAR(std::stod(table.at("camera_x")[n]), key.camera.position.x, 1e-3);
        EXPECT_NEAR(std::stod(table.at("pitch_deg")[n]), degreesFromRadians(key.camera.pitch), 1e-4);
    }
}

TEST_F(ReplayTest, SummarisesAndSaysWhatWasRun) {
    ASSERT_EQ(replay("run", {"--tolerance", "2", "--no-imagery"}), ExitCode::ok);
    const auto summary = Json::parse(textOf(own_ / "run" / "summary.json"));
    ASSERT_TRUE(summary.ok());
    EXPECT_EQ(summary->numberAt("frames").value(), 9);
    EXPECT_GT(summary->numberAt("peakResidentBytes").value(), 1 << 20);
    const Json* frameMs = summary->find("columns")->find("frame_ms");
    ASSERT_NE(frameMs, nullptr);
    EXPECT_LE(frameMs->numberAt("median").value(), frameMs->numberAt("p95").value());
    EXPECT_LE(frameMs->numberAt("p95").value(), frameMs->numberAt("p99").value());
    EXPECT_LE(frameMs->numberAt("p99").value(), frameMs->numberAt("max").value());
    EXPECT_NEAR(frameMs->numberAt("sum").value(), 9 * frameMs->numberAt("mean").value(), 1e-6);
    EXPECT_EQ(summary->find("columns")->find("camera_x"), nullptr);

    const auto manifest = Json::parse(textOf(own_ / "run" / "manifest.json"));
    ASSERT_TRUE(manifest.ok());
    EXPECT_TRUE(manifest->find("build")->stringAt("commit").ok());
    EXPECT_TRUE(manifest->find("graphics")->stringAt("renderer").ok());
    EXPECT_TRUE(manifest->find("dataset")->stringAt("contentHash").ok());
    EXPECT_EQ(manifest->find("flight")->stringAt("crc32c").value().size(), 8u);
    EXPECT_EQ(manifest->find("options")->numberAt("tolerance").value(), 2);
    EXPECT_TRUE(manifest->find("options")->boolAt("no-imagery").value());
    EXPECT_EQ(manifest->find("protocol")->numberAt("width").value(), 64);
}

TEST_F(ReplayTest, FliesByTheClockAndLingersUntilNothingLacks) {
    const auto start = std::chrono::steady_clock::now();
    ASSERT_EQ(replay("run", {"--real-time", "--linger", "60", "--no-statistics"}), ExitCode::ok);
    EXPECT_GE(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 2);
    const auto table = tableOf(own_ / "run" / "frames.csv");
    const std::vector<std::string>& seconds = table.at("seconds");
    for (size_t n = 1; n < seconds.size(); ++n)
        EXPECT_GE(std::stod(seconds[n]) - std::stod(seconds[n - 1]), 0.24) << "--fps 4";
    EXPECT_GE(std::stod(seconds.back()), 1.7) << "a tour of 2 s";
    EXPECT_EQ(table.at("wanted").back(), "0");
    const auto summary = Json::parse(textOf(own_ / "run" / "summary.json"));
    EXPECT_EQ(summary->numberAt("frames").value(), static_cast<double>(seconds.size()));
    EXPECT_GT(summary->numberAt("firstPictureSeconds").value(), 0);
    EXPECT_TRUE(summary->find("prefetch")->numberAt("hitRate").ok());
}

TEST_F(ReplayTest, WithoutStatisticsTheirColumnsAreEmpty) {
    ASSERT_EQ(replay("run", {"--no-statistics"}), ExitCode::ok);
    const auto table = tableOf(own_ / "run" / "frames.csv");
    for (const char* column : {"steps_mean", "steps_p99", "steps_max", "rays", "rays_hit", "rays_out_of_steps"})
        EXPECT_EQ(table.at(column), std::vector<std::string>(9)) << column;
    const auto summary = Json::parse(textOf(own_ / "run" / "summary.json"));
    EXPECT_EQ(summary->find("columns")->find("steps_mean"), nullptr);
}

#if TERRAY_WITH_OUTPUT
TEST_F(ReplayTest, WritesItsFramesAlikeInEveryRun) {
    ASSERT_EQ(replay("a", {"--wait-for-tiles", "--frames"}), ExitCode::ok);
    ASSERT_EQ(replay("b", {"--wait-for-tiles", "--frames", "--upload-budget", "1"}), ExitCode::ok);
    for (int n = 0; n < 9; ++n) {
        const std::string name = "frame_0000" + std::to_string(n) + ".png";
        const std::string picture = textOf(own_ / "a" / "frames" / name);
        EXPECT_GT(picture.size(), 100u);
        EXPECT_EQ(picture, textOf(own_ / "b" / "frames" / name)) << name;
    }
}
#endif

TEST_F(ReplayTest, AnEarlierRunIsReplacedOnlyByForce) {
    ASSERT_EQ(replay("run"), ExitCode::ok);
    std::ofstream(own_ / "run" / "notes.txt") << "mine";
    const std::string before = textOf(own_ / "run" / "manifest.json");
    EXPECT_EQ(replay("run"), ExitCode::output);
    EXPECT_EQ(textOf(own_ / "run" / "manifest.json"), before);
    EXPECT_EQ(replay("run", {"--force", "--no-statistics"}), ExitCode::ok);
    EXPECT_NE(textOf(own_ / "run" / "manifest.json"), before);
    EXPECT_EQ(textOf(own_ / "run" / "notes.txt"), "mine");
}

TEST_F(ReplayTest, BadUseHasItsCodes) {
    EXPECT_EQ(bench({}), ExitCode::usage);
    EXPECT_EQ(bench({"--help"}), ExitCode::ok);
    EXPECT_EQ(bench({"fly"}), ExitCode::usage);
    EXPECT_EQ(bench({"tour", dataset()}), ExitCode::usage);
    EXPECT_EQ(bench({"tour", dataset(), "--out", in("t.json"), "--seconds", "0"}), ExitCode::usage);
    EXPECT_EQ(bench({"replay", dataset(), "--out", in("run")}), ExitCode::usage);
    EXPECT_EQ(replay("run", {"--at-keys"}), ExitCode::usage) << "replay() gives --fps, too";
    EXPECT_EQ(bench({"replay", dataset(), "--flight", tour(), "--out", in("run"), "--fps", "0"}), ExitCode::usage);
    EXPECT_EQ(replay("run", {"--warm-up", "-1"}), ExitCode::usage);
    EXPECT_EQ(replay("run", {"--anisotropy", "99"}), ExitCode::usage);
    EXPECT_EQ(replay("run", {"--marker", "here"}), ExitCode::usage);
    EXPECT_EQ(replay("run", {"--prefetch", "maybe"}), ExitCode::usage);
    EXPECT_EQ(replay("run", {"--real-time", "--wait-for-tiles"}), ExitCode::usage);
    EXPECT_EQ(replay("run", {"--linger", "5"}), ExitCode::usage);
    EXPECT_FALSE(std::filesystem::exists(in("run")));
    EXPECT_FALSE(std::filesystem::exists(in("t.json")));
}

TEST_F(ReplayTest, BadPlacesHaveTheirCodes) {
    EXPECT_EQ(bench({"tour", in("none"), "--out", in("t.json")}), ExitCode::dataset);
    EXPECT_EQ(bench({"tour", dataset(), "--out", in("none/t.json")}), ExitCode::output);
    EXPECT_EQ(bench({"replay", in("none"), "--flight", tour(), "--out", in("run")}), ExitCode::dataset);
    EXPECT_EQ(bench({"replay", dataset(), "--flight", in("none.json"), "--out", in("run")}), ExitCode::input);
    std::ofstream(own_ / "bad.json") << "{\"keys\": 7}";
    EXPECT_EQ(bench({"replay", dataset(), "--flight", in("bad.json"), "--out", in("run")}), ExitCode::input);
    EXPECT_EQ(replay("bad.json/run"), ExitCode::output);  // below a file
    EXPECT_FALSE(std::filesystem::exists(in("run")));
    EXPECT_EQ(bench({"tour", dataset(), "--out", tour()}), ExitCode::output);  // it exists
    EXPECT_EQ(bench({"tour", dataset(), "--out", tour(), "--force"}), ExitCode::ok);
}

TEST_F(ReplayTest, ADamagedTileBreaksTheFlightOffAndLeavesNoHalfRun) {
    const auto copy = own_ / "damaged";
    std::filesystem::copy(dataset(), copy);
    const auto archive = copy / kHeightsFile;
    std::fstream file(archive, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(std::filesystem::file_size(archive)) - 1000);  // in the last tile
    file.write("damage", 6);
    file.close();
    EXPECT_EQ(bench({"replay", copy.string(), "--flight", tour(), "--out", in("run"), "--size", "512x512", "--fps", "4",
                     "--wait-for-tiles"}),
              ExitCode::dataset);
    EXPECT_FALSE(std::filesystem::exists(in("run")));
}

TEST(RayStatistics, CountsWhatEachRayDid) {
    Grid<uint32_t> steps({10, 10});
    Grid<uint32_t> nodes({10, 10});
    for (uint32_t n = 1; n < 100; ++n) {
        steps.cells()[n] = n;  // ray 0 met no box
        nodes.cells()[n] = n < 60 ? n : 0;
    }
    steps.cells()[99] |= 1u << 31;
    const RayStatistics found = measureRays(steps, nodes);
    EXPECT_EQ(found, (RayStatistics{.rays = 100,
                                    .marched = 99,
                                    .hit = 59,
                                    .sky = 41,
                                    .outOfSteps = 1,
                                    .stepsMean = 50,
                                    .stepsP99 = 99,
                                    .stepsMax = 99}));
    EXPECT_EQ(measureRays(Grid<uint32_t>({2, 2}), Grid<uint32_t>({2, 2})), (RayStatistics{.rays = 4, .sky = 4}));
}

}  // namespace
}  // namespace terray
