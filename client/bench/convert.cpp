#include <cstdio>
#include <filesystem>
#include <memory>

#include "client/bench/bench.h"
#include "client/engine/dataset_camera.h"
#include "client/engine/dataset_options.h"
#include "client/engine/program.h"
#include "client/exchange/flight_files.h"
#include "client/stream/flight_editing.h"
#include "common/command_line.h"

namespace terray {
namespace {

void requireAbove(const char* option, double value, double least) {
    if (!(value > least && value <= 1e6))
        throw Error(ExitCode::usage, std::string(option) + ": found " + Json(value).dump() + ", expected above " +
                                         Json(least).dump(0) + ", at most 1e6");
}

void check(const TrackFlightOptions& track) {
    requireAbove("--speed", track.speed, 0);
    requireAbove("--track-speed", track.metresPerSecond, 0);
    requireAbove("--smoothing", track.smoothing, 0);
    requireAbove("--look-ahead", track.lookAhead, 0);
    requireAbove("--clearance", track.clearance, 0);
    requireAbove("--above", track.above, -1e6);
    if (!(track.lookDown >= -90 && track.lookDown <= 90))
        throw Error(ExitCode::usage, "--look-down: expected -90 to 90 degrees");
}

}  // namespace

ExitCode runConvert(const std::vector<std::string>& arguments) {
    constexpr double kThinDegrees = 0.5;
    DatasetCommandLine dataset;
    std::string in, out;
    TrackFlightOptions track;
    std::optional<double> thin;
    bool force = false;
    CommandLine line("terray-bench convert",
                     "Makes a flight of a flight (JSON), a KML tour, or a GPX or IGC track, and writes it as JSON, KML "
                     "or GPX.");
    dataset.declare(line);
    line.option("--flight", in, "FILE", "to read: .json, .kml, .gpx or .igc, told apart by content").required();
    line.option("--out", out, "FILE", "to write: .json, .kml or .gpx").required();
    line.option("--thin", thin, "METRES", "leave out keys that the path keeps so near to without them");
    line.option("--speed", track.speed, "F", "fly a track F times as fast as it was recorded (1)");
    line.option("--track-speed", track.metresPerSecond, "M", "metres a second along a track without times (30)");
    line.option("--smoothing", track.smoothing, "S", "seconds over which a track is averaged (2)");
    line.option("--look-ahead", track.lookAhead, "S", "look to where the camera will be in so many seconds (4)");
    line.option("--look-down", track.lookDown, "DEGREES", "and by so much lower (8)");
    line.option("--above", track.above, "M", "fly so many metres above a track's heights (0)");
    line.option("--clearance", track.clearance, "M", "and at least so many above the ground (20)");
    line.flag("--force", force, "replace an existing file");
    if (!line.parse(arguments)) return ExitCode::ok;
    check(track);
    if (thin) requireAbove("--thin", *thin, 0);
    if (std::filesystem::exists(out) && !force)
        throw Error(ExitCode::output, out + " exists (give --force to replace it)");

    const std::unique_ptr<TileSource> source = dataset.open();
    const std::optional<Projection> projection = projectionOf(source->metadata());
    GroundHeights ground(*source);
    Flight flight = importFlight(in, track, projection ? &*projection : nullptr, ground);
    if (thin) flight = thinned(flight, Metres(*thin), radiansFromDegrees(kThinDegrees));
    throwIfInterrupted();
    exportFlight(flight, out, projection ? &*projection : nullptr);
    std::printf("%s: %zu keys, %.1f seconds\n", out.c_str(), flight.keys.size(), flight.seconds());
    return ExitCode::ok;
}

}  // namespace terray
