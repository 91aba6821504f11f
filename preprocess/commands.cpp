#include "preprocess/commands.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <thread>

#include "common/version.h"
#include "preprocess/block_team.h"

namespace terray {
namespace {

constexpr const char* kHelp =
    "usage: terray-preprocess COMMAND ...\n"
    "\n"
    "Makes Terray datasets of heights and photos, and looks into them.\n"
    "\n"
    "  build DEM... --out DIR   from rasters\n"
    "  synth --size N --out DIR procedural terrain\n"
    "  extract DIR --out DIR    a smaller dataset: part of the ground, or of the levels\n"
    "  info DIR                 what a dataset holds\n"
    "  verify DIR               whether all that a dataset says of itself holds\n"
    "\n"
    "terray-preprocess COMMAND --help says more; terray-preprocess --version says which build this is.\n";

ExitCode printVersion() {
    const BuildInfo& info = buildInfo();
    std::printf("terray-preprocess %.*s (commit %.*s%s, %.*s, %.*s)\n", static_cast<int>(info.version.size()),
                info.version.data(), static_cast<int>(info.commit.size()), info.commit.data(),
                info.dirty ? ", modified" : "", static_cast<int>(info.compiler.size()), info.compiler.data(),
                static_cast<int>(info.build.size()), info.build.data());
    return ExitCode::ok;
}

/// How long a process that cannot go on waits to be ended by the one that leads, once that has told the user why.
constexpr std::chrono::seconds kPatience(30);

using SharedCommand = ExitCode (*)(const std::vector<std::string>&, const std::atomic<bool>&, Ranks*);

/// Runs a command that several processes can share, with those that were started with this one.
ExitCode runShared(SharedCommand command, const std::vector<std::string>& arguments, const std::atomic<bool>& stop) {
    if (!isOneOfSeveral()) return command(arguments, stop, nullptr);
    const std::unique_ptr<Ranks> ranks = joinRanks();
    if (ranks->count() == 1) return command(arguments, stop, nullptr);
    try {
        return command(arguments, stop, ranks.get());
    } catch (const std::exception& error) {
        if (ranks->rank() != 0) TeamMember::giveUp(*ranks, error, kPatience);
        throw;
    }
}

}  // namespace

ExitCode runPreprocess(const std::vector<std::string>& arguments, const std::atomic<bool>& stop) {
    if (arguments.empty()) throw Error(ExitCode::usage, std::string("no command given\n") + kHelp);
    const std::string& command = arguments.front();
    const std::vector<std::string> rest(arguments.begin() + 1, arguments.end());
    if (command == "build") return runShared(runBuild, rest, stop);
    if (command == "synth") return runShared(runSynth, rest, stop);
    if (command == "extract") return runShared(runExtract, rest, stop);
    if (command == "info") return runInfo(rest);
    if (command == "verify") return runVerify(rest, stop);
    if (command == "--version") return printVersion();
    if (command != "--help")
        throw Error(ExitCode::usage,
                    "unknown command \"" + command + "\"; known are build, synth, extract, info and verify");
    std::fputs(kHelp, stdout);
    return ExitCode::ok;
}

int machineJobs() {
    return static_cast<int>(std::max(std::thread::hardware_concurrency(), 1u));
}

}  // namespace terray
