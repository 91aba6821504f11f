// terray-preprocess under mpirun, as on a cluster: true processes over one file system.

#include <csignal>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "common/error.h"
#include "tests/preprocess/test_dataset.h"
#include "tests/support/run_program.h"

namespace terray {
namespace {

using Arguments = std::vector<std::string>;

class Mpi : public testing::Test {
  protected:
    [[nodiscard]] std::string path(const std::string& name) const { return (directory_ / name).string(); }

    static ProgramResult runAlone(Arguments arguments) {
        return execute({.program = TERRAY_PREPROCESS_PROGRAM, .arguments = std::move(arguments)});
    }
    /// @param meanwhile  called again and again while it runs
    static ProgramResult runTogether(int processes, const Arguments& arguments,
                                     const std::function<bool()>& meanwhile = {}) {
        // Root may run it, as in a container; more processes than cores may; Open MPI itself leaks a little at its end.
        Arguments all = {"OMPI_ALLOW_RUN_AS_ROOT=1",
                         "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1",
                         "ASAN_OPTIONS=detect_leaks=0",
                         TERRAY_MPIRUN,
                         "--oversubscribe",
                         "-n",
                         std::to_string(processes),
                         TERRAY_PREPROCESS_PROGRAM};
        all.insert(all.end(), arguments.begin(), arguments.end());
        return execute({.program = "/usr/bin/env", .arguments = std::move(all), .interruptWhen = meanwhile});
    }
    [[nodiscard]] Arguments synth(const std::string& out) const {
        return {"synth", "--size", "5000", "--seed", "3", "--jobs", "1", "--out", path(out)};
    }
    void expectSame(const std::string& one, const std::string& other) const {
        EXPECT_EQ(readFile(directory_ / one / kHeightsFile), readFile(directory_ / other / kHeightsFile));
    }
    /// Processes of terray-preprocess whose output is `out`, other than the first, which leads.
    [[nodiscard]] std::vector<pid_t> members(const std::string& out) const {
        std::vector<pid_t> found;
        for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
            std::ifstream file(entry.path() / "cmdline");
            std::string command{std::istreambuf_iterator<char>(file), {}};
            std::ifstream environment(entry.path() / "environ");
            const std::string variables{std::istreambuf_iterator<char>(environment), {}};
            const bool isOurs =
                command.starts_with(TERRAY_PREPROCESS_PROGRAM) && command.find(path(out)) != std::string::npos;
            if (isOurs && variables.find("OMPI_COMM_WORLD_RANK=1") != std::string::npos)
                found.push_back(static_cast<pid_t>(std::stoi(entry.path().filename())));
        }
        return found;
    }

    TemporaryDirectory directory_;
};

TEST_F(Mpi, ManyProcessesBuildWhatOneBuilds) {
    ASSERT_EQ(runAlone(synth("alone")).exitCode, 0);
    const ProgramResult together = runTogether(3, synth("together"));
    ASSERT_EQ(together.exitCode, 0) << together.err;
    EXPECT_NE(together.out.find("on 3 processes of 1 jobs"), std::string::npos) << together.out;
    EXPECT_EQ(together.out.find("heights: "), together.out.rfind("heights: ")) << "one of them speaks";
    expectSame("alone", "together");
}

TEST_F(Mpi, AKilledProcessEndsTheRunAndItCanBeGoneOnWith) {
    ASSERT_EQ(runAlone(synth("alone")).exitCode, 0);
    bool killed = false;
    const ProgramResult cut = runTogether(3, synth("together"), [&] {
        std::error_code ignored;
        const auto journal = std::filesystem::file_size(path("together.partial/journal"), ignored);
        if (killed || ignored || journal < 4000) return false;
        for (const pid_t process : members("together")) killed = ::kill(process, SIGKILL) == 0 || killed;
        return false;
    });
    ASSERT_TRUE(killed) << "no process was found in time: " << cut.err;
    EXPECT_NE(cut.exitCode, 0);
    EXPECT_EQ(directory_.names(), (std::vector<std::string>{"alone", "together.partial"}));
    Arguments again = synth("together");
    again.emplace_back("--resume");
    const ProgramResult resumed = runTogether(2, again);
    ASSERT_EQ(resumed.exitCode, 0) << resumed.err;
    EXPECT_NE(resumed.err.find("were done before"), std::string::npos) << resumed.err;
    expectSame("alone", "together");
}

TEST_F(Mpi, ARefusalIsSaidOnceWithItsOwnExitCode) {
    ASSERT_EQ(runAlone(synth("out")).exitCode, 0);
    const ProgramResult refused = runTogether(3, synth("out"));
    EXPECT_EQ(refused.exitCode, static_cast<int>(ExitCode::output)) << refused.err;
    const std::string text = "terray-preprocess: output";
    EXPECT_NE(refused.err.find(text), std::string::npos) << refused.err;
    EXPECT_EQ(refused.err.find(text), refused.err.rfind(text)) << refused.err;
}

}  // namespace
}  // namespace terray
