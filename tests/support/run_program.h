#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace terray {

/// How a program is run.
struct ProgramRun {
    std::string program;  ///< path of the executable
    std::vector<std::string> arguments;
    std::optional<uint64_t> maxFileBytes = {};  ///< larger files cannot be written, as on a full disk
    /// Asked again and again while the program runs; once true the program gets SIGINT.
    std::function<bool()> interruptWhen = {};
};

struct ProgramResult {
    int exitCode = -1;  ///< -1: ended by a signal
    std::string out;
    std::string err;
};

/// Runs a program and waits for its end. No shell in between.
[[nodiscard]] ProgramResult execute(const ProgramRun& run);

}  // namespace terray
