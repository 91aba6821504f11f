#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "client/bench/bench.h"
#include "client/bench/frame_table.h"
#include "client/bench/manifest.h"
#include "client/bench/progress_bar.h"
#include "client/bench/run_directory.h"
#include "client/engine/dataset_options.h"
#include "client/engine/draw_costs_file.h"
#include "client/engine/engine.h"
#include "client/engine/engine_options.h"
#include "client/engine/program.h"
#include "client/stream/flight.h"
#include "common/command_line.h"
#if TERRAY_WITH_OUTPUT
#include "client/output/picture.h"
#endif

namespace terray {
namespace {

using Clock = std::chrono::steady_clock;

struct ReplayOptions {
    DatasetCommandLine dataset;
    std::string flight;
    std::string out;
    int width = 1280;
    int height = 720;
    double framesPerSecond = 30;
    bool rateGiven = false;
    bool atKeys = false;
    int64_t warmUpFrames = 3;
    bool pictures = false;
    bool waitForTiles = false;
    bool realTime = false;
    double lingerSeconds = 0;
    bool noStatistics = false;
    bool force = false;
    EngineCommandLine engine;
    EngineOptions drawn;  ///< what `engine` comes to for the dataset
};

bool parse(ReplayOptions& options, const std::vector<std::string>& arguments) {
    CommandLine line("terray-bench replay",
                     "Flies a flight frame by frame at a fixed rate and writes what each frame cost.");
    options.dataset.declare(line);
    line.option("--flight", options.flight, "FLIGHT.json", "made by terray-bench tour, or recorded").required();
    line.option("--out", options.out, "DIR", "for frames.csv, steps.csv, summary.json, manifest.json and frames/")
        .required();
    line.size("--size", options.width, options.height, "of a frame in pixels (1280x720)");
    line.option("--fps", options.framesPerSecond, "N", "frames to a second of the flight (30)")
        .given(options.rateGiven);
    line.flag("--at-keys", options.atKeys, "a frame at each key instead: of a recorded flight, the pictures it was");
    line.flag("--frames", options.pictures, "write each frame as PNG, outside of the times");
    line.flag("--wait-for-tiles", options.waitForTiles,
              "each frame waits until all of its tiles are loaded: the same pictures on every machine");
    line.flag("--real-time", options.realTime,
              "each frame shows where the camera is by then; --fps is the most frames a second");
    line.option(
        "--linger", options.lingerSeconds, "SECONDS",
        "with --real-time: at the end, draw the last camera on until it lacks no tile, for so long at most (0)");
    line.option("--warm-up", options.warmUpFrames, "N", "draw the first frame so often before the flight (3)");
    line.flag("--no-statistics", options.noStatistics,
              "count no rays and steps: their columns stay empty, steps.csv is not written");
    line.flag("--force", options.force, "replace an earlier run in DIR");
    options.engine.declare(line);
    if (!line.parse(arguments)) return false;
    if (!(options.framesPerSecond > 0 && options.framesPerSecond <= 10000))
        throw Error(ExitCode::usage, "--fps: expected a number above 0, at most 10000");
    if (options.atKeys && options.rateGiven)
        throw Error(ExitCode::usage, "found --fps and --at-keys, expected one of them");
    if (options.warmUpFrames < 0 || options.warmUpFrames > 10000)
        throw Error(ExitCode::usage, "--warm-up: expected 0 to 10000 frames");
    if (options.realTime && options.waitForTiles)
        throw Error(ExitCode::usage, "--real-time: found --wait-for-tiles, too; a clock waits for no tile");
    if (!(options.lingerSeconds >= 0 && options.lingerSeconds <= 3600))
        throw Error(ExitCode::usage, "--linger: expected 0 to 3600 seconds");
    if (options.realTime && options.atKeys)
        throw Error(ExitCode::usage, "found --real-time and --at-keys, expected one of them");
    if (options.lingerSeconds > 0 && !options.realTime)
        throw Error(ExitCode::usage, "--linger: expected --real-time with it");
    if (options.pictures && !TERRAY_WITH_OUTPUT)
        throw Error(ExitCode::unsupported, "--frames: this build writes no pictures (TERRAY_WITH_OUTPUT is off)");
    return true;
}

EngineOptions engineOptions(const ReplayOptions& options, const TileSource& source) {
    EngineOptions engine = options.engine.options(source.metadata().imageryLevel.has_value());
    options.engine.place(source, engine);
    engine.features.statistics = !options.noStatistics;
    const ShadingNeeds needs = needsOf(engine.render.shading.mode);
    if (options.noStatistics && (needs.steps || needs.shadowSteps))
        throw Error(ExitCode::usage, "--no-statistics: found a --shading that shows steps, which it leaves uncounted");
    return engine;
}

size_t frameCount(const ReplayOptions& options, const Flight& flight) {
    return options.atKeys ? flight.keys.size() : frameCount(flight, options.framesPerSecond);
}

/// One flight over one dataset, from the first warm-up frame to the last line of the table.
class Replay {
  public:
    /// @param begun  when the dataset began to be opened
    Replay(const ReplayOptions& options, const TileSource& source, const Flight& flight, RunDirectory& directory,
           Clock::time_point begun)
        : begun_(begun),
          options_(options),
          flight_(flight),
          directory_(directory),
          shaders_(options.engine.shaders()),
          engine_(source, shaders_, options.drawn, options.width, options.height),
          table_(directory.table()) {}

    void run() {
        warmUp();
        const Clock::time_point start = Clock::now();
        if (options_.realTime) {
            flyByTheClock(start);
        } else {
            flyFrameByFrame();
        }
        wallSeconds_ = secondsSince(start);
    }

    FrameTable& table() { return table_; }
    [[nodiscard]] const StepHistogram& steps() const { return steps_; }

    /// The launch in use and, where it was chosen by calibration, by how much.
    [[nodiscard]] Json launch() const {
        const auto& calibration = engine_.calibration();
        if (!calibration) return Json::Object{{"chosen", options_.engine.toJson().stringAt("launch").value()}};
        return Json::Object{{"chosen", std::string(name(calibration->chosen))},
                            {"rasterMs", calibration->rasterMs},
                            {"computeMs", calibration->computeMs}};
    }

    [[nodiscard]] Json summary() const {
        return Json::Object{{"frames", uint64_t{frames_}},
                            {"launch", launch()},
                            {"drawCosts", engine_.drawCosts() ? toJson(*engine_.drawCosts()) : Json()},
                            {"earth", engine_.earth().description()},
                            {"shading", description(engine_.shading())},
                            {"wallSeconds", wallSeconds_},
                            {"firstPictureSeconds", firstPictureSeconds_},
                            {"prefetch", prefetch()},
                            {"peakResidentBytes", peakResidentBytes()},
                            {"warmUp", Json::Object{{"frames", options_.warmUpFrames},
                                                    {"readBytes", pagerAtStart_.bytesRead},
                                                    {"requested", pagerAtStart_.requested}}},
                            {"columns", table_.summary()}};
    }

  private:
    static double secondsSince(Clock::time_point start) {
        return std::chrono::duration<double>(Clock::now() - start).count();
    }

    void flyFrameByFrame() {
        const size_t frames = frameCount(options_, flight_);
        ProgressBar progress(frames);
        while (frames_ < frames) {
            fly(options_.atKeys ? flight_.keys[frames_].seconds
                                : static_cast<double>(frames_) / options_.framesPerSecond);
            progress.show(frames_);
        }
    }

    void flyByTheClock(Clock::time_point start) {
        const double end = flight_.seconds() + options_.lingerSeconds;
        const size_t expected = frameCount(flight_, options_.framesPerSecond);
        ProgressBar progress(expected);
        bool lacking = true;
        for (double now = 0; now <= flight_.seconds() || (lacking && now <= end); now = secondsSince(start)) {
            lacking = fly(now).wanted > 0;
            progress.show(std::min(expected, static_cast<size_t>(now * options_.framesPerSecond) + 1));
            const auto next = std::chrono::duration<double>(now + 1 / options_.framesPerSecond);
            std::this_thread::sleep_until(start + std::chrono::duration_cast<Clock::duration>(next));
        }
    }

    /// How far tiles that were read ahead were of use. The hit rate: of the requests that main memory could not have
    /// answered without, those for what had been read ahead, or was being read.
    [[nodiscard]] Json prefetch() const {
        const PrefetchStatistics& ahead = pagerBefore_.prefetch;
        const uint64_t hits = ahead.answered + ahead.joined;
        const uint64_t misses = pagerBefore_.requested - ahead.joined;
        return Json::Object{
            {"tiles", ahead.tiles},
            {"bytes", ahead.bytes},
            {"usedTiles", ahead.usedTiles},
            {"usedBytes", ahead.usedBytes},
            {"answered", ahead.answered},
            {"joined", ahead.joined},
            {"cancelled", ahead.cancelled},
            {"failed", ahead.failed},
            {"hitRate", hits == 0 ? 0 : static_cast<double>(hits) / static_cast<double>(hits + misses)}};
    }

    FrameReport draw(double seconds) {
        throwIfInterrupted();
        FrameReport report = engine_.drawFrame(flight_.at(seconds), options_.waitForTiles);
        if (firstPictureSeconds_ == 0) firstPictureSeconds_ = secondsSince(begun_);
        if (!options_.waitForTiles) report.unreachable.clear();  // as while flying: it is asked for again
        requireAllTiles(report, "the flight was broken off");
        return report;
    }

    void warmUp() {
        for (int64_t n = 0; n < options_.warmUpFrames; ++n) pagerAtStart_ = draw(0).pager;
        pagerBefore_ = pagerAtStart_;
    }

    FrameReport fly(double seconds) {
        const size_t index = frames_++;
        FrameMeasurement frame{.index = index, .seconds = seconds, .camera = flight_.at(seconds)};
        frame.report = draw(seconds);
        frame.pagerBefore = pagerBefore_;
        pagerBefore_ = frame.report.pager;
        // From here on nothing is timed: reading back stalls the GPU.
        const FrameTargets& targets = engine_.targets();
        if (!options_.noStatistics) {
            const Grid<uint32_t> steps = targets.readSteps();
            frame.rays = measureRays(steps, targets.readNodes());
            steps_.add(steps);
        }
#if TERRAY_WITH_OUTPUT
        if (options_.pictures) writePng(directory_.frame(index), targets.readSrgb().view());
#endif
        table_.add(frame);
        return frame.report;
    }

    Clock::time_point begun_;
    const ReplayOptions& options_;
    const Flight& flight_;
    RunDirectory& directory_;
    ShaderLibrary shaders_;
    Engine engine_;
    FrameTable table_;
    StepHistogram steps_;
    size_t frames_ = 0;
    PagerStatistics pagerAtStart_;
    PagerStatistics pagerBefore_;
    double wallSeconds_ = 0;
    double firstPictureSeconds_ = 0;
};

Json protocolOf(const ReplayOptions& options) {
    return Json::Object{{"width", options.width},
                        {"height", options.height},
                        {"fps", options.atKeys ? Json("at keys") : Json(options.framesPerSecond)},
                        {"waitForTiles", options.waitForTiles},
                        {"realTime", options.realTime},
                        {"lingerSeconds", options.lingerSeconds},
                        {"warmUpFrames", options.warmUpFrames},
                        {"statistics", !options.noStatistics},
                        {"pictures", options.pictures}};
}

void printResult(const Replay& replay, FrameTable& table, const RunDirectory& directory, bool statistics) {
    const double frames = replay.summary().numberAt("frames").value();
    std::printf("%.0f frames: median %.1f ms (processor %.1f, graphics %.1f), %.0f nodes\n", frames,
                table.median("frame_ms"), table.median("cpu_ms"), table.median("gpu_ms"), table.median("nodes"));
    const Json launch = replay.launch();
    std::printf("launch: %s", launch.stringAt("chosen").value().c_str());
    if (launch.find("rasterMs") != nullptr)
        std::printf(" (calibration: raster %.1f ms, compute %.1f ms a frame)", launch.numberAt("rasterMs").value(),
                    launch.numberAt("computeMs").value());
    std::printf("\nearth: %s\n", replay.summary().stringAt("earth").value().c_str());
    std::printf("shading: %s\n", replay.summary().stringAt("shading").value().c_str());
    if (const double heights = table.max("heights_coarsening"), imagery = table.max("imagery_coarsening");
        heights > 1 || imagery > 1)
        std::printf(
            "memory: --gpu-memory is too small for all of the flight: tolerances were multiplied by up to %.2f "
            "(heights) and %.2f (photo)\n",
            heights, imagery);
    const Json summary = replay.summary();
    const Json& ahead = *summary.find("prefetch");
    if (ahead.numberAt("tiles").value() > 0)
        std::printf("read ahead: %.0f tiles, %.1f MB, of which %.1f MB were used; hit rate %.0f %%\n",
                    ahead.numberAt("tiles").value(), ahead.numberAt("bytes").value() / 1e6,
                    ahead.numberAt("usedBytes").value() / 1e6, 100 * ahead.numberAt("hitRate").value());
    if (statistics)
        std::printf("steps a ray: mean %.1f, at most %.0f; rays out of steps: %.0f\n", table.median("steps_mean"),
                    table.max("steps_max"), table.sum("rays_out_of_steps"));
    std::printf("written: %s, %s, %s\n", directory.table().c_str(), directory.summary().c_str(),
                directory.manifest().c_str());
}

}  // namespace

ExitCode runReplay(const std::vector<std::string>& arguments) {
    ReplayOptions options;
    if (!parse(options, arguments)) return ExitCode::ok;
    const auto begun = Clock::now();
    const std::unique_ptr<TileSource> source = options.dataset.open();
    const Flight flight = loadFlight(options.flight);
    options.drawn = engineOptions(options, *source);  // refuses what is wrong before anything is created

    RunDirectory directory(options.out, options.pictures, options.force);
    const HeadlessContext context;
    requireRendererFeatures();
    const RunDescription description{.program = "terray-bench replay",
                                     .dataset = options.dataset.place(),
                                     .source = *source,
                                     .flightFile = options.flight,
                                     .flight = flight,
                                     .protocol = protocolOf(options),
                                     .options = options.engine.toJson()};
    const Json manifest = describeRun(description, context.strings(), utcNow());
    Replay replay(options, *source, flight, directory, begun);
    replay.run();
    replay.table().finish();
    if (!options.noStatistics) replay.steps().write(directory.steps());
    writeJson(directory.summary(), replay.summary());
    throwIfInterrupted();
    writeJson(directory.manifest(), manifest);
    directory.keep();
    printResult(replay, replay.table(), directory, !options.noStatistics);
    return ExitCode::ok;
}

}  // namespace terray
