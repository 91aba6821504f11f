#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>

#include "client/bench/bench.h"
#include "client/bench/encoder.h"
#include "client/bench/manifest.h"
#include "client/bench/progress_bar.h"
#include "client/bench/video_parts.h"
#include "client/engine/dataset_options.h"
#include "client/engine/engine.h"
#include "client/engine/engine_options.h"
#include "client/engine/program.h"
#include "client/stream/flight.h"
#include "common/command_line.h"
#include "common/version.h"

namespace terray {
namespace {

struct VideoOptions {
    DatasetCommandLine dataset;
    std::string flight;
    std::string out;
    std::string ffmpeg = "ffmpeg";
    int width = 1920;
    int height = 1080;
    double framesPerSecond = 60;
    int64_t quality = 18;
    int64_t segmentFrames = 300;
    bool resume = false;
    bool force = false;
    EngineCommandLine engine;
};

void check(const VideoOptions& options) {
    if (!(options.framesPerSecond > 0 && options.framesPerSecond <= 1000))
        throw Error(ExitCode::usage, "--fps: expected a number above 0, at most 1000");
    if (options.quality < 0 || options.quality > 51)
        throw Error(ExitCode::usage, "--quality: expected 0 (lossless) to 51");
    if (options.segmentFrames < 1 || options.segmentFrames > 1'000'000)
        throw Error(ExitCode::usage, "--segment: expected 1 to 1000000 frames");
    if (options.width % 2 != 0 || options.height % 2 != 0)
        throw Error(ExitCode::usage, "--size: found " + std::to_string(options.width) + "x" +
                                         std::to_string(options.height) +
                                         ", expected even numbers (colours are stored for 2 x 2 pixels)");
    const std::string ending = std::filesystem::path(options.out).extension().string();
    if (ending != ".mp4" && ending != ".mkv")
        throw Error(ExitCode::usage, "--out: found " + options.out + ", expected a name that ends in .mp4 or .mkv");
    if (std::filesystem::exists(options.out) && !options.force)
        throw Error(ExitCode::output, options.out + " exists (give --force to replace it)");
}

bool parse(VideoOptions& options, const std::vector<std::string>& arguments) {
    CommandLine line("terray-bench video",
                     "Draws a flight frame by frame, each with all of its tiles, and has ffmpeg make an H.264 video.");
    options.dataset.declare(line);
    line.option("--flight", options.flight, "FLIGHT.json", "made by terray-bench tour or convert, or recorded")
        .required();
    line.option("--out", options.out, "VIDEO", "to write, .mp4 or .mkv").required();
    line.size("--size", options.width, options.height, "of a frame in pixels, even (1920x1080)");
    line.option("--fps", options.framesPerSecond, "N", "frames to a second (60)");
    line.option("--quality", options.quality, "CRF", "0 lossless, 18 good, 51 worst (18)");
    line.option("--segment", options.segmentFrames, "FRAMES", "so many are lost at most when it is ended (300)");
    line.flag("--resume", options.resume, "go on with a video that was broken off, with the same options");
    line.option("--ffmpeg", options.ffmpeg, "PROGRAM", "what encodes (ffmpeg)");
    line.flag("--force", options.force, "replace an existing video");
    options.engine.declare(line);
    if (!line.parse(arguments)) return false;
    check(options);
    return true;
}

/// All that a frame or its encoding depends on, but for the launch.
Json describe(const VideoOptions& options, const TileSource& source) {
    const Json file = describeFile(options.flight);
    Json drawn = options.engine.toJson();
    // These decide when tiles come, not what a frame shows once they are there.
    Json shown;
    for (const auto& [name, value] : drawn.object())
        if (name != "decode-threads" && name != "upload-budget") shown.set(name, value);
    return Json::Object{{"commit", std::string(buildInfo().commit)},
                        {"dataset", source.contentHash()},
                        {"flight", file.stringAt("crc32c").value()},
                        {"width", options.width},
                        {"height", options.height},
                        {"fps", options.framesPerSecond},
                        {"quality", options.quality},
                        {"segment", options.segmentFrames},
                        {"options", shown}};
}

std::vector<std::string> encodeArguments(const VideoOptions& options, const std::filesystem::path& out) {
    return {"-hide_banner",
            "-loglevel",
            "error",
            "-y",
            "-f",
            "rawvideo",
            "-pixel_format",
            "rgba",
            "-video_size",
            std::to_string(options.width) + "x" + std::to_string(options.height),
            "-framerate",
            Json(options.framesPerSecond).dump(0),
            "-i",
            "-",
            "-an",
            "-c:v",
            "libx264",
            "-crf",
            std::to_string(options.quality),
            "-pix_fmt",
            "yuv420p",
            "-fflags",
            "+bitexact",
            out.string()};
}

std::vector<std::string> joinArguments(const std::filesystem::path& list, const std::filesystem::path& out) {
    std::vector<std::string> arguments{"-hide_banner", "-loglevel",   "error", "-y",   "-f",      "concat",
                                       "-i",           list.string(), "-c",    "copy", "-fflags", "+bitexact"};
    // So that a player on a network can begin before it has all.
    if (out.extension() == ".mp4") arguments.insert(arguments.end(), {"-movflags", "+faststart"});
    arguments.push_back(out.string());
    return arguments;
}

/// One video, segment by segment.
class Video {
  public:
    Video(const VideoOptions& options, const TileSource& source, const Flight& flight, VideoParts& parts)
        : options_(options),
          flight_(flight),
          parts_(parts),
          shaders_(options.engine.shaders()),
          engine_(source, shaders_, engineOptions(source), options.width, options.height),
          frames_(frameCount(flight, options.framesPerSecond)),
          segments_((frames_ - 1) / perSegment() + 1) {}

    void make() {
        warmUp();
        size_t missing = 0;
        for (size_t segment = 0; segment < segments_; ++segment)
            if (!parts_.has(segment)) missing += end(segment) - begin(segment);
        if (missing < frames_) std::printf("%zu of %zu frames are there\n", frames_ - missing, frames_);
        ProgressBar progress(frames_, frames_ - missing);
        size_t done = frames_ - missing;
        for (size_t segment = 0; segment < segments_; ++segment) {
            if (parts_.has(segment)) continue;
            Encoder encoder(options_.ffmpeg, encodeArguments(options_, parts_.unfinished(segment)), parts_.log());
            for (size_t frame = begin(segment); frame < end(segment); ++frame) {
                encoder.write(draw(frame));
                progress.show(++done);
            }
            encoder.finish();
            parts_.publish(segment);
        }
        runTool(options_.ffmpeg, joinArguments(parts_.list(segments_), parts_.whole()), parts_.log());
        parts_.finish();
    }

    [[nodiscard]] size_t frames() const { return frames_; }

  private:
    [[nodiscard]] size_t perSegment() const { return static_cast<size_t>(options_.segmentFrames); }
    [[nodiscard]] size_t begin(size_t segment) const { return segment * perSegment(); }
    [[nodiscard]] size_t end(size_t segment) const { return std::min((segment + 1) * perSegment(), frames_); }

    [[nodiscard]] EngineOptions engineOptions(const TileSource& source) const {
        EngineOptions engine = options_.engine.options(source.metadata().imageryLevel.has_value());
        options_.engine.place(source, engine);
        const ShadingNeeds needs = needsOf(engine.render.shading.mode);
        engine.features.statistics = needs.steps || needs.shadowSteps;
        if (!parts_.launch().empty()) engine.render.launch = launchNamed(parts_.launch());
        return engine;
    }

    /// Chooses the launch where that was left to us, and notes it: both draw the same but for the last of 255 steps.
    void warmUp() {
        (void)draw(0);
        if (!parts_.launch().empty()) return;
        const auto& calibration = engine_.calibration();
        parts_.setLaunch(calibration ? std::string(name(calibration->chosen))
                                     : options_.engine.toJson().stringAt("launch").value());
    }

    ByteView draw(size_t frame) {
        throwIfInterrupted();
        const double seconds = static_cast<double>(frame) / options_.framesPerSecond;
        requireAllTiles(engine_.drawFrame(flight_.at(seconds), true), "the video was broken off, --resume goes on");
        picture_ = engine_.targets().readSrgb();
        return std::as_bytes(std::span(picture_.cells()));
    }

    const VideoOptions& options_;
    const Flight& flight_;
    VideoParts& parts_;
    ShaderLibrary shaders_;
    Engine engine_;
    size_t frames_;
    size_t segments_;
    Grid<std::array<uint8_t, 4>> picture_;
};

}  // namespace

ExitCode runVideo(const std::vector<std::string>& arguments) {
    VideoOptions options;
    if (!parse(options, arguments)) return ExitCode::ok;
    const std::unique_ptr<TileSource> source = options.dataset.open();
    const Flight flight = loadFlight(options.flight);
    runTool(options.ffmpeg, {"-version"}, "/dev/null");  // before hours of drawing

    const HeadlessContext context;
    requireRendererFeatures();
    VideoParts parts(options.out, describe(options, *source), options.resume);
    Video video(options, *source, flight, parts);
    video.make();
    std::printf("%s: %zu frames, %.1f seconds\n", options.out.c_str(), video.frames(),
                static_cast<double>(video.frames()) / options.framesPerSecond);
    return ExitCode::ok;
}

}  // namespace terray
