#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "common/error.h"
#include "preprocess/ranks.h"

namespace terray {

/// Runs terray-preprocess as if called with `arguments` (without the program's name); output goes to stdout and stderr.
/// @param stop  once true, the work ends soon with Error(interrupted); what a build has done stays for --resume
/// Throws Error, which is for main to print.
[[nodiscard]] ExitCode runPreprocess(const std::vector<std::string>& arguments, const std::atomic<bool>& stop);

// The sub-commands, with the arguments after their names. `ranks`: the processes that were started to run the same one
// together; nullptr: none.
[[nodiscard]] ExitCode runBuild(const std::vector<std::string>& arguments, const std::atomic<bool>& stop, Ranks* ranks);
[[nodiscard]] ExitCode runSynth(const std::vector<std::string>& arguments, const std::atomic<bool>& stop, Ranks* ranks);
[[nodiscard]] ExitCode runExtract(const std::vector<std::string>& arguments, const std::atomic<bool>& stop,
                                  Ranks* ranks);
[[nodiscard]] ExitCode runInfo(const std::vector<std::string>& arguments);
[[nodiscard]] ExitCode runVerify(const std::vector<std::string>& arguments, const std::atomic<bool>& stop);

/// Threads that this machine runs at once, at least 1.
[[nodiscard]] int machineJobs();

}  // namespace terray
