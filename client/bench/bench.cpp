#include "client/bench/bench.h"

#include <cstdio>

namespace terray {
namespace {

constexpr const char* kUsage =
    "usage: terray-bench COMMAND ...\n"
    "  tour DATASET --out FLIGHT.json      writes the dataset's standard flight\n"
    "  convert DATASET --flight FILE --out FILE\n"
    "                                      flights and tracks from and to JSON, KML, GPX, IGC\n"
    "  replay DATASET --flight FLIGHT.json --out DIR\n"
    "                                      flies it at a fixed rate and writes what each frame cost\n"
    "  video DATASET --flight FLIGHT.json --out VIDEO.mp4\n"
    "                                      draws it at fixed time steps and has ffmpeg make a video\n"
    "  error DATASET --flight FLIGHT.json --out DIR\n"
    "                                      measures its pictures against the truth, and their time\n"
    "  compare RUN_A RUN_B                 holds the figures of one run against another's, and fails if told when\n"
    "  stability                           casts rays that are hard on arithmetic, and fails if one ends wrongly\n"
    "  image-error REFERENCE TEST          compares two pictures, or the frames of two replays: FLIP and PSNR\n"
    "Each command tells its options with --help; terray-bench --version says what was built.\n";

}  // namespace

ExitCode runBench(const std::vector<std::string>& arguments) {
    const std::string command = arguments.empty() ? "" : arguments.front();
    if (command == "--help") {
        std::fputs(kUsage, stdout);
        return ExitCode::ok;
    }
    const std::vector<std::string> rest(arguments.begin() + (arguments.empty() ? 0 : 1), arguments.end());
    if (command == "tour") return runTour(rest);
    if (command == "convert") return runConvert(rest);
    if (command == "replay") return runReplay(rest);
    if (command == "video") return runVideo(rest);
    if (command == "error") return runError(rest);
    if (command == "compare") return runCompare(rest);
    if (command == "stability") return runStability(rest);
    if (command == "image-error") return runImageError(rest);
    const std::string found = command.empty() ? "found no command" : "found the command \"" + command + "\"";
    throw Error(ExitCode::usage,
                found +
                    ", expected tour, convert, replay, video, error, compare, stability or image-error "
                    "(--help tells more)");
}

}  // namespace terray
