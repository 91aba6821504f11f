// terray-bench and terray-view as processes: what signals and limits do to them.

#include <gtest/gtest.h>

#include "client/bench/bench.h"
#include "common/error.h"
#include "tests/common/temporary_directory.h"
#include "tests/support/analytic_dataset.h"
#include "tests/support/run_program.h"

namespace terray {
namespace {

/// Beside the dataset and the flight lies only what a program leaves.
class ClientProgram : public testing::Test {
  protected:
    void SetUp() override {
        std::filesystem::create_directory(directory_ / "dataset");
        AnalyticDataset({.finestLevel = 1, .imageryLevel = 1}).write(directory_ / "dataset");
        ASSERT_EQ(runBench({"tour", path("dataset"), "--seconds", "60", "--out", path("flight.json")}), ExitCode::ok);
        ASSERT_EQ(directory_.entries(), 2U);
    }
    [[nodiscard]] std::string path(const std::string& name) const { return (directory_ / name).string(); }
    [[nodiscard]] ProgramRun replay(const std::vector<std::string>& more = {}) const {
        ProgramRun run{.program = TERRAY_BENCH_PROGRAM,
                       .arguments = {"replay", path("dataset"), "--flight", path("flight.json"), "--size", "64x48",
                                     "--out", path("run")}};
        run.arguments.insert(run.arguments.end(), more.begin(), more.end());
        return run;
    }
    /// The exit code, one line on stderr, and no new file.
    void expectRefusal(const ProgramRun& run, ExitCode code, const std::string& text) const {
        const ProgramResult result = execute(run);
        EXPECT_EQ(result.exitCode, static_cast<int>(code)) << result.err;
        EXPECT_NE(result.err.find(text), std::string::npos) << result.err;
        EXPECT_EQ(directory_.entries(), 2U);
    }

    test::TemporaryDirectory directory_;
};

constexpr uint64_t kTooFewBytes = 1024;  // for a table, a flight or a picture; enough for the message

TEST_F(ClientProgram, AnInterruptedReplayLeavesNothing) {
    ProgramRun run = replay();
    run.interruptWhen = [&] { return std::filesystem::exists(directory_ / "run"); };
    expectRefusal(run, ExitCode::interrupted, "terray-bench: interrupted");
}

TEST_F(ClientProgram, AnOptionIsRefusedUnderTheProgramsNameOnce) {
    expectRefusal(replay({"--bogus"}), ExitCode::usage, "terray-bench: unknown option --bogus");
}

TEST_F(ClientProgram, AFileThatMayNotGrowLeavesNothing) {
    ProgramRun run = replay();
    run.maxFileBytes = kTooFewBytes;
    expectRefusal(run, ExitCode::output, "File too large");
    expectRefusal({.program = TERRAY_BENCH_PROGRAM,
                   .arguments = {"tour", path("dataset"), "--out", path("other.json")},
                   .maxFileBytes = kTooFewBytes},
                  ExitCode::output, "File too large");
}

#if TERRAY_WITH_OUTPUT
TEST_F(ClientProgram, AReplayWithPicturesLeavesNoneWhenInterrupted) {
    ProgramRun run = replay({"--frames"});
    run.interruptWhen = [&] { return std::filesystem::exists(directory_ / "run" / "frames" / "frame_00002.png"); };
    expectRefusal(run, ExitCode::interrupted, "terray-bench: interrupted");
}

TEST_F(ClientProgram, APictureThatMayNotGrowLeavesNothing) {
    for (const char* name : {"a.png", "a.exr"})
        expectRefusal({.program = TERRAY_VIEW_PROGRAM,
                       .arguments = {path("dataset"), "--headless", "--size", "64x48", "--out", path(name)},
                       .maxFileBytes = kTooFewBytes},
                      ExitCode::output, "File too large");
}
#endif

}  // namespace
}  // namespace terray
