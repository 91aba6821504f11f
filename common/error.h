#pragma once

#include <stdexcept>
#include <string>

namespace terray {

/// What a program's exit status tells a script. The table in README.md is the same one; the numbers never change
/// meaning.
enum class ExitCode : int {
    ok = 0,
    internal = 1,      ///< a defect in Terray, or an exception nobody expected
    usage = 2,         ///< unknown or contradictory options
    input = 3,         ///< a source is missing, is no raster, is cut short or empty
    output = 4,        ///< the output exists (no --force), is not writable, or the disk is full
    dataset = 5,       ///< not a dataset, a damaged one, or one of another format version
    georeference = 6,  ///< sources do not overlap, or their coordinate system is missing or unusable
    graphics = 7,      ///< no EGL or OpenGL 4.5, or a shader that does not compile
    verification = 8,  ///< `verify`, or the stability suite, ran to its end and found faults
    unsupported = 9,   ///< this build lacks the optional library that the request needs
    network = 10,      ///< an address cannot be listened at, or a server cannot be reached
    threshold = 11,    ///< `compare` ran to its end and found a threshold of --fail-if crossed
    display = 12,      ///< no display to open a window on
    interrupted = 130  ///< stopped by SIGINT
};

/// A program cannot start or go on. Thrown anywhere, caught only in main, which prints what() and exits with code().
///
/// The message says what was attempted, on which thing, what was found, what was expected, and what to do.
class Error : public std::runtime_error {
  public:
    Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    [[nodiscard]] ExitCode code() const noexcept { return code_; }

  private:
    ExitCode code_;
};

}  // namespace terray
