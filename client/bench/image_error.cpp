#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "client/bench/bench.h"
#include "client/engine/program.h"
#include "common/command_line.h"
#include "common/json.h"
#include "common/reference/picture_error.h"
#if TERRAY_WITH_OUTPUT
#include "client/output/picture.h"
#endif

namespace terray {
namespace {

namespace fs = std::filesystem;

struct ImageErrorOptions {
    std::string reference;
    std::string test;
    double pixelsPerDegree = kFlipPixelsPerDegree;
    std::string map;
    bool json = false;
};

bool parse(ImageErrorOptions& options, const std::vector<std::string>& arguments) {
    CommandLine line("terray-bench image-error",
                     "Says how far pictures, or the frames of two replays, are from each other.");
    line.positional("REFERENCE", options.reference, "a picture of 8 bits a channel, or DIR of replay --frames")
        .required();
    line.positional("TEST", options.test, "likewise").required();
    line.option("--pixels-per-degree", options.pixelsPerDegree, "N",
                "of the viewer's field (67.02: a screen 0.7 m wide of 3840 columns, at 0.7 m)");
    line.option("--map", options.map, "OUT.png", "writes FLIP of each pixel: black none, red, yellow, white all");
    line.flag("--json", options.json, "print JSON");
    if (!line.parse(arguments)) return false;
    if (!(options.pixelsPerDegree >= 1 && options.pixelsPerDegree <= 1000))
        throw Error(ExitCode::usage,
                    "--pixels-per-degree: found " + Json(options.pixelsPerDegree).dump() + ", expected 1 to 1000");
    return true;
}

#if TERRAY_WITH_OUTPUT

/// The numbered pictures of a replay, by name.
std::vector<std::string> framesOf(const fs::path& run) {
    std::vector<std::string> names;
    std::error_code failure;
    for (const fs::directory_entry& entry : fs::directory_iterator(run / "frames", failure))
        if (entry.path().extension() == ".png") names.push_back(entry.path().filename().string());
    if (names.empty())
        throw Error(ExitCode::input,
                    "no frames in " + (run / "frames").string() + " (a replay writes them with --frames)");
    std::sort(names.begin(), names.end());
    return names;
}

struct Pair {
    std::string name;
    fs::path reference;
    fs::path test;
};

/// What is compared with what: the two files, or the frames of the two runs, which must be the same ones.
std::vector<Pair> pairsOf(const ImageErrorOptions& options) {
    const bool runs = fs::is_directory(options.reference);
    if (runs != fs::is_directory(options.test))
        throw Error(ExitCode::input, "cannot compare " + options.reference + " with " + options.test +
                                         ": expected two pictures or two directories of replays");
    if (!runs) return {{fs::path(options.test).filename().string(), options.reference, options.test}};
    const std::vector<std::string> names = framesOf(options.reference);
    const std::vector<std::string> others = framesOf(options.test);
    if (names != others)
        throw Error(ExitCode::input, "cannot compare the runs: " + options.reference + " has the frames " +
                                         names.front() + " to " + names.back() + ", " + options.test + " has " +
                                         others.front() + " to " + others.back());
    std::vector<Pair> pairs;
    for (const std::string& name : names)
        pairs.push_back(
            {name, fs::path(options.reference) / "frames" / name, fs::path(options.test) / "frames" / name});
    return pairs;
}

std::string sizeOf(const Grid<Rgba>& picture) {
    return std::to_string(picture.width()) + "x" + std::to_string(picture.height());
}

void writeMap(const fs::path& path, const Grid<float>& flip) {
    Grid<Rgba> map(flip.size());
    std::transform(flip.cells().begin(), flip.cells().end(), map.cells().begin(), heatColour);
    writePng(path, map.view());
}

PictureError compare(const Pair& pair, const ImageErrorOptions& options) {
    const Grid<Rgba> reference = readPicture(pair.reference);
    const Grid<Rgba> test = readPicture(pair.test);
    if (reference.size() != test.size())
        throw Error(ExitCode::input, "cannot compare " + pair.reference.string() + " of " + sizeOf(reference) +
                                         " pixels with " + pair.test.string() + " of " + sizeOf(test));
    const Grid<float> flip = flipOf(reference.view(), test.view(), options.pixelsPerDegree);
    if (!options.map.empty()) writeMap(options.map, flip);
    return measurePictures(reference.view(), test.view(), flip);
}

Json toJson(const PictureError& error) {
    return Json::Object{{"flipMean", error.flip.mean},  {"flipMedian", error.flip.median},
                        {"flipP95", error.flip.p95},    {"flipP99", error.flip.p99},
                        {"flipMax", error.flip.max},    {"psnrDb", error.psnr ? Json(*error.psnr) : Json()},
                        {"differing", error.differing}, {"greatestDifference", error.greatest}};
}

void print(const std::string& name, const PictureError& error) {
    const std::string psnr = error.psnr ? Json(std::round(*error.psnr * 100) / 100).dump() + " dB" : "none (equal)";
    std::printf(
        "%s: FLIP mean %.6f, median %.4f, p95 %.4f, p99 %.4f, max %.4f; PSNR %s; %.4f %% of pixels differ, "
        "by at most %u\n",
        name.c_str(), error.flip.mean, error.flip.median, error.flip.p95, error.flip.p99, error.flip.max, psnr.c_str(),
        100 * error.differing, error.greatest);
}

void report(const std::vector<Pair>& pairs, const std::vector<PictureError>& errors, const ImageErrorOptions& options) {
    double sum = 0;
    size_t worst = 0;
    Json::Array frames;
    for (size_t n = 0; n < pairs.size(); ++n) {
        sum += errors[n].flip.mean;
        if (errors[n].flip.mean > errors[worst].flip.mean) worst = n;
        Json frame = toJson(errors[n]);
        frame.set("name", pairs[n].name);
        frames.push_back(std::move(frame));
        if (!options.json) print(pairs[n].name, errors[n]);
    }
    const double mean = sum / static_cast<double>(pairs.size());
    if (options.json) {
        const Json json = Json::Object{{"reference", options.reference},
                                       {"test", options.test},
                                       {"pixelsPerDegree", options.pixelsPerDegree},
                                       {"flipMean", mean},
                                       {"worst", pairs[worst].name},
                                       {"pictures", std::move(frames)}};
        std::printf("%s\n", json.dump().c_str());
    } else if (pairs.size() > 1) {
        std::printf("%zu frames: FLIP mean %.6f, worst %.6f in %s\n", pairs.size(), mean, errors[worst].flip.mean,
                    pairs[worst].name.c_str());
    }
}

ExitCode compareAll(const ImageErrorOptions& options) {
    const std::vector<Pair> pairs = pairsOf(options);
    if (pairs.size() > 1 && !options.map.empty())
        throw Error(ExitCode::usage, "--map: expected two pictures, found runs of several frames");
    std::vector<PictureError> errors;
    for (const Pair& pair : pairs) {
        throwIfInterrupted();
        errors.push_back(compare(pair, options));
    }
    report(pairs, errors, options);
    return ExitCode::ok;
}

#else

ExitCode compareAll(const ImageErrorOptions&) {
    throw Error(ExitCode::unsupported, "image-error: this build reads no pictures (TERRAY_WITH_OUTPUT is off)");
}

#endif

}  // namespace

ExitCode runImageError(const std::vector<std::string>& arguments) {
    ImageErrorOptions options;
    if (!parse(options, arguments)) return ExitCode::ok;
    return compareAll(options);
}

}  // namespace terray
