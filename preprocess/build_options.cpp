#include "preprocess/build_options.h"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <sstream>
#include <vector>

#include "common/json.h"
#include "common/parse_number.h"
#include "preprocess/block_plan.h"
#include "preprocess/output_directory.h"

namespace terray {
namespace {

constexpr int64_t kMaxJobs = 1024;
/// Metres; their doubles are quanta that a tile can have (HeightEncoding::valid).
constexpr double kLeastError = 1e-6;
constexpr double kGreatestError = 1e4;

/// Builds, and ends the display whether that works or not.
BuildSummary buildWithDisplay(const HeightSource& heights, const OpenPhoto& openPhoto, const BuildRequest& request) {
    struct EndOfDisplay {
        BuildObserver& observer;
        ~EndOfDisplay() { observer.end(); }
    } const endOfDisplay{*request.observer};
    return buildDataset(heights, openPhoto, request);
}

void printEstimate(const BuildEstimate& estimate, const SharedOptions& shared) {
    if (shared.style() == ProgressStyle::json) {
        const Json json(Json::Object{{"event", "estimate"},
                                     {"heightTiles", estimate.heightTiles},
                                     {"imageryTiles", estimate.imageryTiles},
                                     {"archiveBytes", estimate.archiveBytes},
                                     {"diskBytes", estimate.diskBytes},
                                     {"memoryBytes", estimate.memoryBytes},
                                     {"seconds", estimate.seconds},
                                     {"jobs", estimate.jobs}});
        std::printf("%s\n", json.dump(0).c_str());
    }
    if (shared.style() == ProgressStyle::automatic) std::fputs(toText(estimate, shared.out).c_str(), stdout);
}

}  // namespace

SharedOptions::SharedOptions(Ranks* others) : ranks(others) {
    if (ranks != nullptr) jobs = std::max<int64_t>(jobs / ranks->onThisMachine(), 1);
}

void SharedOptions::declare(CommandLine& line) {
    line.option("--out", out, "DIR", "the dataset's directory, made by this run").required();
    line.option("--jobs", jobs, "N", "threads of each process; default: one for each core");
    line.bytes("--memory", memoryBytes,
               "memory for each process to stay within, whatever the size of the sources; default: 1G");
    line.option("--max-height-error", maxHeightError, "METRES",
                "that no height may be off by; default: half a step of codes, of 1 cm (1 mm for lidar) or as wide as a "
                "tile's range needs");
    line.flag("--force", force, "replace the dataset that --out holds");
    line.flag("--resume", resume, "go on with a build of --out that was stopped or killed, if there is one");
    line.flag("--dry-run", dryRun, "only estimate tiles, bytes, disk, memory and time; writes nothing");
    line.flag("--quiet", quiet, "print nothing but errors");
    line.flag("--json-progress", jsonProgress, "print progress and result as one JSON object for each line");
}

void SharedOptions::check() const {
    if (quiet && jsonProgress)
        throw Error(ExitCode::usage, "--quiet and --json-progress contradict each other; give one of them");
    if (maxHeightError && (!(*maxHeightError >= kLeastError) || *maxHeightError > kGreatestError))
        throw Error(ExitCode::usage, "--max-height-error is " + readableNumber(*maxHeightError) +
                                         " m; it must be from " + readableNumber(kLeastError) + " to " +
                                         readableNumber(kGreatestError));
    if (jobs < 1 || jobs > kMaxJobs)
        throw Error(ExitCode::usage,
                    "--jobs is " + std::to_string(jobs) + "; it must be from 1 to " + std::to_string(kMaxJobs));
    if (memoryBytes < kMinMemoryBytes)
        throw Error(ExitCode::usage, "--memory is " + std::to_string(memoryBytes) + " bytes; at least " +
                                         std::to_string(kMinMemoryBytes >> 20) + " MiB are needed (--memory 256M)");
    if (leads()) OutputDirectory::check(out, {.replace = force, .resume = resume});
}

void SharedOptions::describe(OptionsText& text) const {
    if (maxHeightError) text.add("--max-height-error", *maxHeightError);
}

ProgressStyle SharedOptions::style() const {
    if (quiet || !leads()) return ProgressStyle::silent;
    return jsonProgress ? ProgressStyle::json : ProgressStyle::automatic;
}

BuildRequest SharedOptions::request(const std::string& optionsText, const std::atomic<bool>& stop,
                                    BuildObserver& observer) const {
    return {.out = out,
            .replace = force,
            .resume = resume,
            .jobs = static_cast<int>(jobs),
            .memoryBytes = memoryBytes,
            .optionsText = optionsText,
            .maxHeightError = maxHeightError,
            .stop = &stop,
            .observer = &observer,
            .ranks = ranks};
}

void OptionsText::add(const std::string& name, double value) {
    add(name, Json(value).dump(0));
}

GroundRect parseBounds(const std::string& text) {
    std::vector<double> numbers;
    std::istringstream parts(text);
    for (std::string part; std::getline(parts, part, ',');) {
        if (const auto number = parseNumber(part)) numbers.push_back(*number);
    }
    const bool isWhole = numbers.size() == 4 && std::ranges::count(text, ',') == 3;
    if (!isWhole || numbers[0] >= numbers[2] || numbers[1] >= numbers[3])
        throw Error(ExitCode::usage,
                    "--bbox is \"" + text +
                        "\"; expected west,south,east,north in metres, west below east and south below "
                        "north, such as 500000,5100000,520000,5120000");
    return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

void buildOrEstimate(const HeightSource& heights, const OpenPhoto& openPhoto, const BuildRequest& request,
                     const SharedOptions& shared) {
    if (!shared.dryRun) {
        printSummary(buildWithDisplay(heights, openPhoto, request), shared.style());
        return;
    }
    if (!shared.leads()) return;
    const BuildEstimate estimate = estimateDataset(heights, openPhoto, request);
    printEstimate(estimate, shared);
    requireSpace(estimate, shared.out);
}

}  // namespace terray
