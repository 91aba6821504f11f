#pragma once

#include <string>
#include <vector>

#include "common/error.h"

namespace terray {

/// The program terray-bench without its name: the first argument is the sub-command. Throws Error as README's table of
/// exit codes says. Needs no current GL context: replay makes its own.
ExitCode runBench(const std::vector<std::string>& arguments);

/// `terray-bench tour`: writes the dataset's standard flight.
ExitCode runTour(const std::vector<std::string>& arguments);

/// `terray-bench convert`: flights from and to KML, GPX and IGC; client/README.md, "Other programs' flights".
ExitCode runConvert(const std::vector<std::string>& arguments);

/// `terray-bench replay`: flies a flight frame by frame at a fixed rate and writes what each frame cost. The files are
/// documented in client/README.md, "Replay output".
ExitCode runReplay(const std::vector<std::string>& arguments);

/// `terray-bench video`: a flight as an H.264 video, by ffmpeg; client/README.md, "Videos".
ExitCode runVideo(const std::vector<std::string>& arguments);

/// `terray-bench error`: measures how far pictures of a flight are from the truth, and how long they take, for one or
/// several settings. The files are documented in client/README.md, "Error against run time".
ExitCode runError(const std::vector<std::string>& arguments);

/// `terray-bench compare`: holds the figures of two runs of replay or error against each other. Throws Error(usage)
/// when they were not measured alike. Returns ExitCode::threshold when a limit of --fail-if is crossed.
ExitCode runCompare(const std::vector<std::string>& arguments);

/// `terray-bench stability`: casts rays at grounds and from places that are hard on arithmetic. Returns
/// ExitCode::verification when one ends wrongly. Described in client/README.md, "Stability".
ExitCode runStability(const std::vector<std::string>& arguments);

/// `terray-bench image-error`: says how far pictures, or the frames of two replays, are from each other. Throws
/// Error(unsupported) in a build without pictures.
ExitCode runImageError(const std::vector<std::string>& arguments);

}  // namespace terray
