// terray-preprocess as users and scripts see it: arguments in; exit code, text and files out.

#include <fstream>

#include <gtest/gtest.h>

#include "common/error.h"
#include "common/json.h"
#include "preprocess/dataset_archives.h"
#include "tests/preprocess/test_dataset.h"
#include "tests/support/run_program.h"

namespace terray {
namespace {

using Names = std::vector<std::string>;

class Program : public testing::Test {
  protected:
    [[nodiscard]] std::string path(const std::string& name) const { return (directory_ / name).string(); }

    static ProgramResult run(std::vector<std::string> arguments) {
        return execute({.program = TERRAY_PREPROCESS_PROGRAM, .arguments = std::move(arguments)});
    }
    /// Builds a small dataset of procedural terrain; it must go well.
    void synth(const std::string& name, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments = {"synth", "--size", "700", "--seed", "3", "--out", path(name)};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const ProgramResult result = run(arguments);
        ASSERT_EQ(result.exitCode, 0) << result.err;
    }
    /// Expects a refusal: its exit code, one line on stderr that begins with the program's name and holds `text`.
    static void expectRefusal(const ProgramResult& result, ExitCode code, const std::string& text) {
        EXPECT_EQ(result.exitCode, static_cast<int>(code)) << result.err;
        EXPECT_EQ(result.err.find("terray-preprocess: "), 0u) << result.err;
        EXPECT_NE(result.err.find(text), std::string::npos) << result.err;
    }

    TemporaryDirectory directory_;
};

TEST_F(Program, SynthesisesInspectsAndVerifies) {
    const ProgramResult built = run({"synth", "--size", "700", "--spacing", "2", "--out", path("out")});
    EXPECT_EQ(built.exitCode, 0) << built.err;
    EXPECT_NE(built.out.find("heights: 5 tiles"), std::string::npos) << built.out;
    EXPECT_NE(built.out.find("error by level"), std::string::npos);
    for (const char* step : {"\n  read ", "\n  warp ", "\n  reduce ", "\n  encode ", "\n  write "})
        EXPECT_NE(built.out.find(step), std::string::npos) << built.out;
    EXPECT_NE(built.err.find("heights 1 to 0: 1 blocks"), std::string::npos) << built.err;
    EXPECT_EQ(directory_.names(), Names{"out"});

    const ProgramResult info = run({"info", path("out")});
    EXPECT_EQ(info.exitCode, 0);
    EXPECT_NE(info.out.find("700 x 700 samples, 2 m apart"), std::string::npos) << info.out;
    const ProgramResult json = run({"info", path("out"), "--json"});
    const auto parsed = Json::parse(json.out);
    ASSERT_TRUE(parsed.ok()) << parsed.failure().message;
    EXPECT_EQ(metadataFromJson(*parsed->find("metadata")).value().heightTiles, 5u);

    const ProgramResult verified = run({"verify", path("out")});
    EXPECT_EQ(verified.exitCode, 0) << verified.err;
    EXPECT_NE(verified.out.find("5 height tiles, 0 imagery tiles, 0 faults"), std::string::npos) << verified.out;
}

TEST_F(Program, ExtractsPartsThatVerifyAndNameWhereTheyAreFrom) {
    synth("whole");
    const DatasetMetadata whole = openDataset(directory_ / "whole").metadata;
    const GroundRect ground = whole.groundBounds();
    const std::string area = std::to_string(ground.west + 10) + "," + std::to_string(ground.north - 40) + "," +
                             std::to_string(ground.west + 60) + "," + std::to_string(ground.north - 5);
    const ProgramResult result = run({"extract", path("whole"), "--bbox", area, "--out", path("part")});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(run({"verify", path("part")}).exitCode, 0);
    const DatasetMetadata part = openDataset(directory_ / "part").metadata;
    EXPECT_EQ(part.options, "extract --bbox " + area + " of: " + whole.options);
    EXPECT_LT(part.samples.count(), whole.samples.count());
    expectRefusal(run({"extract", path("whole"), "--levels", "31", "--out", path("none")}), ExitCode::usage,
                  "has levels 0 to");
    expectRefusal(run({"extract", path("nowhere"), "--out", path("none")}), ExitCode::dataset, "no such directory");
}

TEST_F(Program, SameOptionsMakeTheSameBytes) {
    const std::vector<std::string> imagery =
        TERRAY_WITH_STB ? std::vector<std::string>{"--imagery"} : std::vector<std::string>{};
    auto more = imagery;
    more.insert(more.end(), {"--jobs", "1", "--memory", "256M", "--quiet"});
    synth("a", imagery);
    synth("b", more);
    for (const char* name : {kHeightsFile, kImageryFile}) {
        if (!std::filesystem::exists(directory_ / "a" / name)) continue;
        EXPECT_EQ(readFile(directory_ / "a" / name), readFile(directory_ / "b" / name)) << name;
    }
}

TEST_F(Program, ProgressIsOneJsonObjectForEachLine) {
    const ProgramResult result = run({"synth", "--size", "600", "--out", path("out"), "--json-progress"});
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_EQ(result.err, "");
    std::istringstream lines(result.out);
    std::string line;
    std::string last;
    while (std::getline(lines, line)) {
        const auto json = Json::parse(line);
        ASSERT_TRUE(json.ok()) << line;
        last = json->stringAt("event").value();
    }
    EXPECT_EQ(last, "done");
}

TEST_F(Program, QuietPrintsNothing) {
    const ProgramResult result = run({"synth", "--size", "10", "--out", path("out"), "--quiet"});
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_EQ(result.out + result.err, "");
}

TEST_F(Program, HelpAndVersionAreNoErrors) {
    for (const char* command : {"build", "synth", "extract", "info", "verify"}) {
        const ProgramResult help = run({command, "--help"});
        EXPECT_EQ(help.exitCode, 0);
        EXPECT_NE(help.out.find(std::string("terray-preprocess ") + command), std::string::npos) << help.out;
    }
    EXPECT_EQ(run({"--help"}).exitCode, 0);
    EXPECT_NE(run({"--version"}).out.find("terray-preprocess "), std::string::npos);
}

TEST_F(Program, RefusesWrongUsage) {
    expectRefusal(run({}), ExitCode::usage, "no command");
    expectRefusal(run({"biuld"}), ExitCode::usage, "biuld");
    expectRefusal(run({"synth", "--sise", "9", "--out", path("out")}), ExitCode::usage, "--size");
    expectRefusal(run({"synth", "--size", "9"}), ExitCode::usage, "--out");
    expectRefusal(run({"synth", "--size", "0", "--out", path("out")}), ExitCode::usage, "--size is 0");
    expectRefusal(run({"synth", "--size", "-5", "--out", path("out")}), ExitCode::usage, "--size");
    expectRefusal(run({"synth", "--size", "9", "--spacing", "0", "--out", path("out")}), ExitCode::usage, "--spacing");
    expectRefusal(run({"synth", "--size", "9", "--jobs", "0", "--out", path("out")}), ExitCode::usage, "--jobs");
    expectRefusal(run({"synth", "--size", "9", "--memory", "1M", "--out", path("out")}), ExitCode::usage, "256 MiB");
    expectRefusal(run({"synth", "--size", "9", "--quiet", "--json-progress", "--out", path("out")}), ExitCode::usage,
                  "--quiet");
    expectRefusal(run({"synth", "--size", "9", "--max-height-error", "0", "--out", path("out")}), ExitCode::usage,
                  "--max-height-error is 0 m");
    expectRefusal(run({"build", "--out", path("out")}), ExitCode::usage, "DEM");
    EXPECT_TRUE(directory_.names().empty());
}

TEST_F(Program, DoesNotTouchExistingOutputWithoutForce) {
    synth("out");
    const Bytes before = readFile(directory_ / "out" / kHeightsFile);
    expectRefusal(run({"synth", "--size", "20", "--out", path("out")}), ExitCode::output, "--force");
    EXPECT_EQ(readFile(directory_ / "out" / kHeightsFile), before);
    EXPECT_EQ(run({"synth", "--size", "20", "--out", path("out"), "--force"}).exitCode, 0);
    EXPECT_NE(readFile(directory_ / "out" / kHeightsFile), before);
    EXPECT_EQ(directory_.names(), Names{"out"});
}

TEST_F(Program, ForceDoesNotDeleteWhatIsNoDataset) {
    std::filesystem::create_directory(directory_ / "photos");
    std::ofstream(directory_ / "photos" / "holiday.jpg") << "x";
    expectRefusal(run({"synth", "--size", "20", "--out", path("photos"), "--force"}), ExitCode::output, "holiday.jpg");
    EXPECT_TRUE(std::filesystem::exists(directory_ / "photos" / "holiday.jpg"));
}

TEST_F(Program, RefusesOutputThatCannotBeWritten) {
    // Also for root, who may write nearly everywhere: the process directory takes no new entries.
    expectRefusal(run({"synth", "--size", "20", "--out", "/proc/self/dataset"}), ExitCode::output, "/proc/");
    std::ofstream(directory_ / "file") << "x";
    expectRefusal(run({"synth", "--size", "20", "--out", path("file/out")}), ExitCode::output, "not a directory");
    expectRefusal(run({"synth", "--size", "20", "--out", path("missing/out")}), ExitCode::output, "not a directory");
    EXPECT_EQ(directory_.names(), Names{"file"});
}

TEST_F(Program, AFullDiskIsNamedAndTheBuildGoesOnOnceThereIsSpace) {
    // Each limit strikes elsewhere: the journal, the tiles, the level between two stages; the archive's last byte.
    for (const std::string size : {"2100", "600"}) {
        EXPECT_EQ(run({"synth", "--size", size, "--seed", "3", "--out", path("whole")}).exitCode, 0);
        const Bytes whole = readFile(directory_ / "whole" / kHeightsFile);
        const std::vector<std::string> arguments = {"synth", "--size",  size,      "--seed",  "3",
                                                    "--out", path("o"), "--quiet", "--resume"};
        for (const uint64_t limit : {uint64_t{0}, uint64_t{4096}, uint64_t{100000}, uint64_t{whole.size() - 1}}) {
            const ProgramResult result =
                execute({.program = TERRAY_PREPROCESS_PROGRAM, .arguments = arguments, .maxFileBytes = limit});
            // With no byte allowed not even the message can be written to the file that stands in for stderr.
            if (limit == 0)
                EXPECT_EQ(result.exitCode, static_cast<int>(ExitCode::output));
            else
                expectRefusal(result, ExitCode::output, "File too large");
            EXPECT_FALSE(std::filesystem::exists(directory_ / "o")) << limit;
        }
        // Of the larger one not even the first block's part of the level above fits under the last limit.
        EXPECT_TRUE(size == "2100" || std::filesystem::exists(directory_ / "o.partial"));
        const ProgramResult resumed = run(arguments);
        EXPECT_EQ(resumed.exitCode, 0) << resumed.err;
        EXPECT_EQ(readFile(directory_ / "o" / kHeightsFile), whole);
        std::filesystem::remove_all(directory_ / "o");
        std::filesystem::remove_all(directory_ / "whole");
    }
}

TEST_F(Program, AnInterruptBeforeTheFirstBlockLeavesNothingBehind) {
    const std::filesystem::path tiles = directory_ / "out.partial" / "work" / "heights-tiles";
    const ProgramResult result = execute({.program = TERRAY_PREPROCESS_PROGRAM,
                                          .arguments = {"synth", "--size", "60000", "--out", path("out"), "--quiet"},
                                          .interruptWhen = [&] { return std::filesystem::exists(tiles); }});
    expectRefusal(result, ExitCode::interrupted, "interrupted");
    EXPECT_TRUE(directory_.names().empty());
}

TEST_F(Program, AnInterruptedBuildIsResumed) {
    const std::filesystem::path journal = directory_ / "out.partial" / "journal";
    const std::vector<std::string> arguments = {"synth", "--size",    "2600",   "--memory", "256M",
                                                "--out", path("out"), "--jobs", "1"};
    const ProgramResult stopped =
        execute({.program = TERRAY_PREPROCESS_PROGRAM, .arguments = arguments, .interruptWhen = [&] {
                     std::error_code ignored;
                     const auto bytes = std::filesystem::file_size(journal, ignored);
                     return !ignored && bytes > 1800;  // the heading and a block or two
                 }});
    EXPECT_EQ(stopped.exitCode, static_cast<int>(ExitCode::interrupted)) << stopped.err;
    EXPECT_NE(stopped.err.find("interrupted (what is done is kept in"), std::string::npos) << stopped.err;
    EXPECT_EQ(directory_.names(), Names{"out.partial"});

    auto changed = arguments;
    changed.insert(changed.end(), {"--seed", "8", "--resume"});
    expectRefusal(run(changed), ExitCode::usage, "options was");
    auto same = arguments;
    same.emplace_back("--resume");
    const ProgramResult resumed = run(same);
    EXPECT_EQ(resumed.exitCode, 0) << resumed.err;
    EXPECT_NE(resumed.err.find("blocks were done before"), std::string::npos) << resumed.err;
    EXPECT_EQ(run({"verify", path("out")}).exitCode, 0);
}

TEST_F(Program, ADryRunEstimatesAndWritesNothing) {
    const std::vector<std::string> arguments = {"synth", "--size", "3000", "--out", path("out")};
    auto dry = arguments;
    dry.insert(dry.end(), {"--dry-run", "--json-progress"});
    const ProgramResult estimated = run(dry);
    EXPECT_EQ(estimated.exitCode, 0) << estimated.err;
    EXPECT_TRUE(directory_.names().empty());
    const auto estimate = Json::parse(estimated.out);
    ASSERT_TRUE(estimate.ok()) << estimated.out;
    // 6 x 6, 3 x 3, 2 x 2 and 1 tiles; a fractal is as rough everywhere, but for its lake.
    EXPECT_EQ(estimate->numberAt("heightTiles").value(), 50);
    EXPECT_EQ(run(arguments).exitCode, 0);
    const auto bytes = static_cast<double>(std::filesystem::file_size(directory_ / "out" / kHeightsFile));
    EXPECT_NEAR(estimate->numberAt("archiveBytes").value(), bytes, bytes / 2);
    EXPECT_GE(estimate->numberAt("diskBytes").value(), 1.9 * estimate->numberAt("archiveBytes").value());

    const ProgramResult text = run({"synth", "--size", "3000", "--out", path("other"), "--dry-run"});
    EXPECT_NE(text.out.find("tiles: at most 50 of heights"), std::string::npos) << text.out;
    EXPECT_EQ(directory_.names(), Names{"out"});
}

TEST_F(Program, RefusesABuildThatTheDiskCannotHold) {
    // 2^29 samples along a side are 2.9e17; no disk holds a tenth of a byte for each.
    const std::vector<std::string> arguments = {"synth", "--size", "536870912", "--out", path("out")};
    expectRefusal(run(arguments), ExitCode::output, "are needed while it is built");
    auto dry = arguments;
    dry.emplace_back("--dry-run");
    expectRefusal(run(dry), ExitCode::output, "are needed while it is built");
    EXPECT_TRUE(directory_.names().empty());
}

TEST_F(Program, RefusesWhatIsNoDataset) {
    expectRefusal(run({"verify", path("missing")}), ExitCode::dataset, "no such directory");
    expectRefusal(run({"info", path("missing")}), ExitCode::dataset, "no such directory");
    std::filesystem::create_directory(directory_ / "empty");
    expectRefusal(run({"verify", path("empty")}), ExitCode::dataset, "not a Terray dataset");
}

TEST_F(Program, RefusesATruncatedArchive) {
    synth("out");
    const Bytes whole = readFile(directory_ / "out" / kHeightsFile);
    for (const size_t length : {size_t{0}, size_t{100}, size_t{500}, whole.size() / 2, whole.size() - 1}) {
        writeFile(directory_ / "out" / kHeightsFile, ByteView(whole).first(length));
        for (const char* command : {"info", "verify"})
            expectRefusal(run({command, path("out")}), ExitCode::dataset, "heights.pmtiles");
    }
}

TEST_F(Program, NamesTheTileWithAFlippedBit) {
    synth("out");
    Bytes bytes = readFile(directory_ / "out" / kHeightsFile);
    bytes[bytes.size() - 100] ^= std::byte{16};  // in the last tile of the curve
    writeFile(directory_ / "out" / kHeightsFile, bytes);
    const ProgramResult result = run({"verify", path("out")});
    EXPECT_EQ(result.exitCode, static_cast<int>(ExitCode::verification));
    EXPECT_EQ(result.err.find("heights 1/1/0: "), 0u) << result.err;
    EXPECT_NE(result.out.find("1 faults"), std::string::npos) << result.out;
}

TEST_F(Program, RefusesAnArchiveOfAFutureVersion) {
    synth("out");
    rewriteArchive(directory_ / "out" / kHeightsFile, [](Payloads&, std::string& text) {
        Json json = Json::parse(text).value();
        json.set("format", kDatasetFormat + 1);
        text = json.dump();
    });
    for (const char* command : {"info", "verify"})
        expectRefusal(run({command, path("out")}), ExitCode::dataset, "format 2");
    // The archive's own version is a byte of its header.
    Bytes bytes = readFile(directory_ / "out" / kHeightsFile);
    bytes[7] = std::byte{4};
    writeFile(directory_ / "out" / kHeightsFile, bytes);
    expectRefusal(run({"verify", path("out")}), ExitCode::dataset, "version");
}

#if !TERRAY_WITH_STB
TEST_F(Program, SaysWhichLibraryImageryNeeds) {
    expectRefusal(run({"synth", "--size", "20", "--imagery", "--out", path("out")}), ExitCode::unsupported, "stb");
    EXPECT_TRUE(directory_.names().empty());
}
#endif

#if !TERRAY_WITH_GDAL
TEST_F(Program, SaysWhichLibraryRastersNeed) {
    expectRefusal(run({"build", "a.tif", "--out", path("out")}), ExitCode::unsupported, "GDAL");
    EXPECT_TRUE(directory_.names().empty());
}
#else
TEST_F(Program, RefusesAreasAndPrioritiesThatAreNone) {
    for (const char* area : {"1,2,3", "1,2,3,4,5", "3,2,1,4", "1,4,3,2", "1,2,x,4", "1,2,3,4,", "1,,3,4"})
        expectRefusal(run({"build", "a.tif", "--bbox", area, "--out", path("out")}), ExitCode::usage, "--bbox is");
    expectRefusal(run({"build", "a.tif", "--priority", "size", "--out", path("out")}), ExitCode::usage,
                  "--priority is");
    expectRefusal(run({"build", "a.tif", "--fill-nodata", "yes", "--out", path("out")}), ExitCode::usage,
                  "--fill-nodata is");
    expectRefusal(run({"build", "@" + path("absent"), "--out", path("out")}), ExitCode::input, "list of files");
}

TEST_F(Program, NamesASourceThatIsMissing) {
    expectRefusal(run({"build", path("missing.tif"), "--out", path("out")}), ExitCode::input, "missing.tif");
    std::ofstream(directory_ / "text.tif") << "this is no raster";
    expectRefusal(run({"build", path("text.tif"), "--out", path("out")}), ExitCode::input, "text.tif");
    EXPECT_EQ(directory_.names(), Names{"text.tif"});
}
#endif

}  // namespace
}  // namespace terray
