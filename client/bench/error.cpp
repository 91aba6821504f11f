#include "common/error.h"

#include <cstdio>
#include <memory>
#include <span>

#include "client/bench/bench.h"
#include "client/bench/error_report.h"
#include "client/bench/manifest.h"
#include "client/bench/run_directory.h"
#include "client/engine/dataset_options.h"
#include "client/engine/engine_options.h"
#include "client/engine/program.h"
#include "common/command_line.h"
#include "common/output_file.h"

namespace terray {
namespace {

struct ErrorOptions {
    DatasetCommandLine dataset;
    std::string flight;
    std::string out;
    std::string sweep;
    ErrorProtocol protocol;
    int64_t frames = ErrorProtocol().frames;
    int64_t repeats = ErrorProtocol().repeats;
    int64_t supersampling = ErrorProtocol().supersampling;
    bool split = false;
    bool maps = false;
    bool force = false;
    EngineCommandLine engine;
};

void requireRange(const char* name, int64_t value, int64_t least, int64_t most) {
    if (value < least || value > most)
        throw Error(ExitCode::usage, std::string(name) + ": found " + std::to_string(value) + ", expected " +
                                         std::to_string(least) + " to " + std::to_string(most));
}

bool parse(ErrorOptions& options, const std::vector<std::string>& arguments) {
    CommandLine line("terray-bench error", "Measures a flight's pictures against the truth, and how long they take.");
    options.dataset.declare(line);
    line.option("--flight", options.flight, "FLIGHT.json", "made by terray-bench tour, or recorded").required();
    line.option("--out", options.out, "DIR", "for errors.csv, summary.json, manifest.json and maps/").required();
    line.option("--sweep", options.sweep, sweepNames(),
                "measure these settings one after the other, not the options as given alone");
    line.flag("--split", options.split, "instead, split the error of the options as given into its causes");
    line.size("--size", options.protocol.width, options.protocol.height, "of a frame in pixels (640x360)");
    line.option("--frames", options.frames, "N", "spread evenly over the flight (8)");
    line.option("--pixels", options.protocol.pixels, "N", "of each frame held against the truth; 0: all (20000)");
    line.option("--repeats", options.repeats, "N", "of the timed frames, after one untimed round (5)");
    line.option("--supersampling", options.supersampling, "N",
                "of the pictures that pictures are held against: samples along a pixel's side (2)");
    line.option("--fps", options.protocol.framesPerSecond, "N",
                "of the flight: each frame and the one after it tell how much detail pops in (30)");
    line.flag("--maps", options.maps, "write the errors of each frame's pixels as PNG and EXR; takes all pixels");
    line.flag("--force", options.force, "replace an earlier run in DIR");
    options.engine.declare(line);
    if (!line.parse(arguments)) return false;
    requireRange("--frames", options.frames, 1, 10000);
    requireRange("--repeats", options.repeats, 1, 1000);
    requireRange("--supersampling", options.supersampling, 1, 8);
    if (!(options.protocol.framesPerSecond > 0 && options.protocol.framesPerSecond <= 10000))
        throw Error(ExitCode::usage, "--fps: expected a number above 0, at most 10000");
    requireRange("--pixels", options.protocol.pixels, 0, INT64_MAX);
    if (options.split && (options.maps || !options.sweep.empty()))
        throw Error(ExitCode::usage, "--split: found --sweep or --maps, expected neither");
    if (options.maps && !TERRAY_WITH_OUTPUT)
        throw Error(ExitCode::unsupported, "--maps: this build writes no pictures (TERRAY_WITH_OUTPUT is off)");
    options.protocol.frames = static_cast<int>(options.frames);
    options.protocol.repeats = static_cast<int>(options.repeats);
    options.protocol.supersampling = static_cast<int>(options.supersampling);
    if (options.maps) options.protocol.pixels = 0;
    return true;
}

Json toJson(const ErrorProtocol& protocol) {
    return Json::Object{{"width", protocol.width},
                        {"height", protocol.height},
                        {"frames", protocol.frames},
                        {"pixels", protocol.pixels},
                        {"repeats", protocol.repeats},
                        {"waitForTiles", true},
                        {"supersampling", protocol.supersampling},
                        {"fps", protocol.framesPerSecond}};
}

template <class Result>
Json summaryOf(const std::vector<Result>& results) {
    Json settings = Json::Array{};
    for (const Result& result : results) settings.push(toJson(result));
    return Json::Object{{"settings", std::move(settings)}};
}

/// What is drawn and measured.
struct Scene {
    const TileSource& source;
    const ShaderLibrary& shaders;
    const Flight& flight;
    const EngineOptions& base;
};

std::vector<ErrorResult> measureSettings(const Scene& scene, const std::vector<ErrorSetting>& settings,
                                         const ErrorOptions& options, const RunDirectory& directory) {
    ErrorMeasurement measurement(scene.source, scene.shaders, scene.flight, options.protocol);
    measurement.drawReferences(scene.base);
    TakeErrors take;
    if (options.maps)
        take = [&](const std::string& setting, int frame, const std::vector<PixelError>& errors) {
            writeErrorMaps(directory.maps(), setting, frame, {options.protocol.width, options.protocol.height}, errors);
        };
    std::vector<ErrorResult> results;
    for (const ErrorSetting& setting : settings) {
        results.push_back(measurement.measure(setting, take));
        std::printf("%s\n", lineOf(results.back()).c_str());
        std::fflush(stdout);
    }
    return results;
}

std::vector<CauseResult> measureCauses(const Scene& scene, const ErrorProtocol& protocol) {
    ErrorSplit split(scene.source, scene.shaders, scene.flight, protocol, scene.base);
    std::vector<CauseResult> results = split.measure();
    for (const CauseResult& result : results) std::printf("%s\n", lineOf(result).c_str());
    return results;
}

/// Writes a run whole.
void write(RunDirectory& directory, const std::filesystem::path& tableFile, const std::string& table,
           const Json& summary, const Json& manifest) {
    writeWholeFile(tableFile, std::as_bytes(std::span(table)));
    writeJson(directory.summary(), summary);
    writeJson(directory.manifest(), manifest);
    directory.keep();
    std::printf("written: %s, %s, %s\n", tableFile.c_str(), directory.summary().c_str(), directory.manifest().c_str());
}

}  // namespace

ExitCode runError(const std::vector<std::string>& arguments) {
    ErrorOptions options;
    if (!parse(options, arguments)) return ExitCode::ok;
    const std::unique_ptr<TileSource> source = options.dataset.open();
    const Flight flight = loadFlight(options.flight);
    EngineOptions base = options.engine.options(source->metadata().imageryLevel.has_value());
    options.engine.place(*source, base);
    if (!base.edits.empty())
        throw Error(ExitCode::usage, "--edits: errors are measured against the dataset's own ground; leave it out");
    const std::vector<ErrorSetting> settings = settingsOf(options.sweep, base, source->metadata().quantum);

    RunDirectory directory(options.out, false, options.force);
    const HeadlessContext context;
    requireRendererFeatures();
    const RunDescription description{.program = "terray-bench error",
                                     .dataset = options.dataset.place(),
                                     .source = *source,
                                     .flightFile = options.flight,
                                     .flight = flight,
                                     .protocol = toJson(options.protocol),
                                     .options = options.engine.toJson()};
    Json manifest = describeRun(description, context.strings(), utcNow());
    manifest.set("sweep", options.split ? Json("split") : options.sweep.empty() ? Json() : Json(options.sweep));

    const ShaderLibrary shaders = options.engine.shaders();
    const Scene scene{*source, shaders, flight, base};
    if (options.split) {
        const std::vector<CauseResult> causes = measureCauses(scene, options.protocol);
        write(directory, directory.split(), splitTable(causes), summaryOf(causes), manifest);
    } else {
        const std::vector<ErrorResult> results = measureSettings(scene, settings, options, directory);
        write(directory, directory.errors(), errorTable(results), summaryOf(results), manifest);
    }
    return ExitCode::ok;
}

}  // namespace terray
