#include <cstdio>
#include <filesystem>
#include <memory>

#include "client/bench/bench.h"
#include "client/engine/dataset_camera.h"
#include "client/engine/dataset_options.h"
#include "client/engine/program.h"
#include "client/stream/flight.h"
#include "common/command_line.h"

namespace terray {
namespace {

/// "standard, take-off, ..."
std::string kindNames() {
    std::string names;
    for (const TourKindName& kind : kTourKinds) names += (names.empty() ? "" : ", ") + std::string(kind.name);
    return names;
}

TourKind kindNamed(const std::string& name) {
    for (const TourKindName& kind : kTourKinds)
        if (kind.name == name) return kind.kind;
    throw Error(ExitCode::usage, "--kind: found \"" + name + "\", expected " + kindNames());
}

}  // namespace

ExitCode runTour(const std::vector<std::string>& arguments) {
    constexpr double kMostSeconds = 86400;
    DatasetCommandLine dataset;
    std::string out;
    double seconds = 30;
    std::string kind = "standard";
    bool force = false;
    CommandLine line("terray-bench tour", "Writes a standard flight made from the dataset's extent and heights.");
    dataset.declare(line);
    line.option("--out", out, "FLIGHT.json", "where the flight goes").required();
    line.option("--seconds", seconds, "S", "how long it takes (30)");
    line.option("--kind", kind, "KIND", kindNames() + " (standard)");
    line.flag("--force", force, "replace an existing flight");
    if (!line.parse(arguments)) return ExitCode::ok;
    if (!(seconds >= 1 && seconds <= kMostSeconds))
        throw Error(ExitCode::usage, "--seconds: found " + Json(seconds).dump() + ", expected 1 to 86400");
    const TourKind flown = kindNamed(kind);
    if (std::filesystem::exists(out) && !force)
        throw Error(ExitCode::output, out + " exists (give --force to replace it)");

    const std::unique_ptr<TileSource> source = dataset.open();
    const std::optional<Projection> projection = projectionOf(source->metadata());
    const Flight flight = standardTour(*source, seconds, flown);
    throwIfInterrupted();
    saveFlight(flight, out, projection ? &*projection : nullptr);
    std::printf("%s: %zu keys, %.1f seconds\n", out.c_str(), flight.keys.size(), flight.seconds());
    return ExitCode::ok;
}

}  // namespace terray
