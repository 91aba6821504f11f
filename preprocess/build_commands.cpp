#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include "common/command_line.h"
#include "common/json.h"
#include "preprocess/block_plan.h"
#include "preprocess/commands.h"
#include "preprocess/dataset_builder.h"
#include "preprocess/output_directory.h"
#include "preprocess/progress.h"
#include "preprocess/raster_files.h"

namespace terray {
namespace {

constexpr int64_t kMaxJobs = 1024;
constexpr int64_t kMaxSynthSize = int64_t{1} << 29;

/// Options that build and synth share.
struct SharedOptions {
    std::string out;
    int64_t jobs = machineJobs();
    uint64_t memoryBytes = uint64_t{1} << 30;
    bool force = false;
    bool resume = false;
    bool quiet = false;
    bool jsonProgress = false;

    void declare(CommandLine& line) {
        line.option("--out", out, "DIR", "the dataset's directory, made by this run").required();
        line.option("--jobs", jobs, "N", "threads; default: one for each core");
        line.bytes("--memory", memoryBytes, "memory to stay within, whatever the size of the sources; default: 1G");
        line.flag("--force", force, "replace the dataset that --out holds");
        line.flag("--resume", resume, "go on with a build of --out that was stopped or killed, if there is one");
        line.flag("--quiet", quiet, "print nothing but errors");
        line.flag("--json-progress", jsonProgress, "print progress and result as one JSON object for each line");
    }

    /// Refuses what can be refused before any work.
    void check() const {
        if (quiet && jsonProgress)
            throw Error(ExitCode::usage, "--quiet and --json-progress contradict each other; give one of them");
        if (jobs < 1 || jobs > kMaxJobs)
            throw Error(ExitCode::usage,
                        "--jobs is " + std::to_string(jobs) + "; it must be from 1 to " + std::to_string(kMaxJobs));
        if (memoryBytes < kMinMemoryBytes)
            throw Error(ExitCode::usage, "--memory is " + std::to_string(memoryBytes) + " bytes; at least " +
                                             std::to_string(kMinMemoryBytes >> 20) + " MiB are needed (--memory 256M)");
        OutputDirectory::check(out, {.replace = force, .resume = resume});
    }
    [[nodiscard]] ProgressStyle style() const {
        if (quiet) return ProgressStyle::silent;
        return jsonProgress ? ProgressStyle::json : ProgressStyle::automatic;
    }
    [[nodiscard]] BuildRequest request(const std::string& optionsText, const std::atomic<bool>& stop,
                                       BuildObserver& observer) const {
        return {.out = out,
                .replace = force,
                .resume = resume,
                .jobs = static_cast<int>(jobs),
                .memoryBytes = memoryBytes,
                .optionsText = optionsText,
                .stop = &stop,
                .observer = &observer};
    }
};

/// The options that shape a result, as text for the dataset's metadata.
class OptionsText {
  public:
    explicit OptionsText(std::string command) : text_(std::move(command)) {}

    void add(const std::string& name, double value) { add(name, Json(value).dump(0)); }
    void add(const std::string& name, const std::string& value) { text_ += " " + name + " " + value; }
    void add(const std::string& flag) { text_ += " " + flag; }
    [[nodiscard]] const std::string& text() const { return text_; }

  private:
    std::string text_;
};

void requirePositive(const std::string& name, double value) {
    if (value > 0 && std::isfinite(value)) return;
    throw Error(ExitCode::usage, name + " is " + readableNumber(value) + "; it must be a number above 0");
}

/// Builds, and ends the display whether that works or not.
BuildSummary buildWithDisplay(const HeightSource& heights, const OpenPhoto& openPhoto, const BuildRequest& request) {
    struct EndOfDisplay {
        BuildObserver& observer;
        ~EndOfDisplay() { observer.end(); }
    } const endOfDisplay{*request.observer};
    return buildDataset(heights, openPhoto, request);
}

/// What a user asked `build` for.
struct BuildOptions {
    HeightSourceOptions heights;
    std::vector<std::string> imagery;
    SharedOptions shared;

    void declare(CommandLine& line) {
        line.positionals("DEM", heights.files, "heights: georeferenced rasters, later ones on top, or one plain image")
            .required();
        line.list("--imagery", imagery, "FILE", "photos to drape over the heights, later ones on top");
        line.option("--crs", heights.crs, "AUTH:CODE",
                    "metric coordinate system of the dataset; default: the source's, or one chosen");
        line.option("--spacing", heights.spacing, "METRES", "between samples; needed for plain images");
        line.option("--height-scale", heights.heightScale, "S", "metres for one unit of the source, such as 0.3048");
        line.option("--height-offset", heights.heightOffset, "O", "metres to add to all heights");
        line.option("--nodata", heights.nodata, "V", "value of the source that stands for no surface");
        shared.declare(line);
    }
    void check() const {
        if (heights.spacing) requirePositive("--spacing", *heights.spacing);
        if (heights.heightScale && (*heights.heightScale == 0 || !std::isfinite(*heights.heightScale)))
            throw Error(ExitCode::usage, "--height-scale must be a number other than 0");
        if (!std::isfinite(heights.heightOffset))
            throw Error(ExitCode::usage, "--height-offset must be a finite number");
        shared.check();
    }
    /// Paths are not part of it: the metadata lists the sources with sizes and times.
    [[nodiscard]] std::string text() const {
        OptionsText options("build");
        if (!heights.crs.empty()) options.add("--crs", heights.crs);
        if (heights.spacing) options.add("--spacing", *heights.spacing);
        if (heights.heightScale) options.add("--height-scale", *heights.heightScale);
        if (heights.heightOffset != 0) options.add("--height-offset", heights.heightOffset);
        if (heights.nodata) options.add("--nodata", *heights.nodata);
        return options.text();
    }
};

std::unique_ptr<HeightSource> openHeights(const HeightSourceOptions& options) {
    const bool isImage = options.files.size() == 1 && isPlainImage(options.files.front());
    return isImage ? openImageHeights(options) : openGdalHeights(options);
}

}  // namespace

ExitCode runBuild(const std::vector<std::string>& arguments, const std::atomic<bool>& stop) {
    BuildOptions options;
    CommandLine line("terray-preprocess build", "Builds a dataset from height rasters and, if given, photos.");
    options.declare(line);
    if (!line.parse(arguments)) return ExitCode::ok;
    options.check();

    const std::unique_ptr<BuildObserver> observer = makeObserver(options.shared.style());
    options.heights.cacheBytes = cacheShare(options.shared.memoryBytes);
    options.heights.note = [&](const std::string& text) { observer->note(text); };
    const std::unique_ptr<HeightSource> heights = openHeights(options.heights);
    OpenPhoto openPhoto;
    if (!options.imagery.empty())
        openPhoto = [&](const Tiling& tiling, const HeightGridInfo& info) {
            return openGdalPhotos(options.imagery, tiling, info.size, info.crsWkt, options.heights.cacheBytes);
        };
    const BuildSummary summary =
        buildWithDisplay(*heights, openPhoto, options.shared.request(options.text(), stop, *observer));
    printSummary(summary, options.shared.style());
    return ExitCode::ok;
}

ExitCode runSynth(const std::vector<std::string>& arguments, const std::atomic<bool>& stop) {
    int64_t size = 0;
    double spacing = 1;
    int64_t seed = 1;
    bool imagery = false;
    SharedOptions shared;
    CommandLine line("terray-preprocess synth", "Builds a dataset of procedural terrain, the same for the same seed.");
    line.option("--size", size, "N", "samples along each side").required();
    line.option("--spacing", spacing, "METRES", "between samples; default: 1");
    line.option("--seed", seed, "S", "which terrain, a whole number; default: 1");
    line.flag("--imagery", imagery, "with a photo, twice as fine as the heights");
    shared.declare(line);
    if (!line.parse(arguments)) return ExitCode::ok;
    if (size < 1 || size > kMaxSynthSize)
        throw Error(ExitCode::usage,
                    "--size is " + std::to_string(size) + "; it must be from 1 to " + std::to_string(kMaxSynthSize));
    requirePositive("--spacing", spacing);
    shared.check();

    OptionsText text("synth");
    text.add("--size", std::to_string(size));
    text.add("--spacing", spacing);
    text.add("--seed", std::to_string(seed));
    if (imagery) text.add("--imagery");
    const SyntheticTerrain terrain{.size = size, .spacing = spacing, .seed = static_cast<uint64_t>(seed)};
    const std::unique_ptr<HeightSource> heights = makeSyntheticHeights(terrain);
    OpenPhoto openPhoto;
    if (imagery)
        openPhoto = [&](const Tiling& tiling, const HeightGridInfo&) { return makeSyntheticPhoto(terrain, tiling); };
    const std::unique_ptr<BuildObserver> observer = makeObserver(shared.style());
    const BuildSummary summary = buildWithDisplay(*heights, openPhoto, shared.request(text.text(), stop, *observer));
    printSummary(summary, shared.style());
    return ExitCode::ok;
}

}  // namespace terray
