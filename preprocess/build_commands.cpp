#include <cmath>
#include <memory>
#include <string>

#include "preprocess/block_plan.h"
#include "preprocess/build_options.h"
#include "preprocess/file_lists.h"
#include "preprocess/filled_heights.h"
#include "preprocess/raster_files.h"
#include "preprocess/shifted_heights.h"

namespace terray {
namespace {

constexpr int64_t kMaxSynthSize = int64_t{1} << 29;

void requirePositive(const std::string& name, double value) {
    if (value > 0 && std::isfinite(value)) return;
    throw Error(ExitCode::usage, name + " is " + readableNumber(value) + "; it must be a number above 0");
}

MosaicPriority parsePriority(const std::string& text) {
    if (text == "order") return MosaicPriority::order;
    if (text == "resolution") return MosaicPriority::resolution;
    throw Error(ExitCode::usage, "--priority is \"" + text + "\"; expected resolution or order");
}

NodataPolicy parseNodataPolicy(const std::string& text) {
    if (text == "none") return NodataPolicy::holes;
    for (const NodataPolicy policy : {NodataPolicy::sea, NodataPolicy::interpolate})
        if (text == nameOf(policy)) return policy;
    throw Error(ExitCode::usage, "--fill-nodata is \"" + text + "\"; expected none, sea or interpolate");
}

/// What a user asked `build` for.
struct BuildOptions {
    HeightSourceOptions heights;
    PhotoSourceOptions imagery;
    std::string bbox;
    std::string priority = "resolution";
    std::string verticalCrs;
    std::string fillNodataText = "none";
    NodataPolicy nodataPolicy = NodataPolicy::holes;
    SharedOptions shared;

    explicit BuildOptions(Ranks* ranks) : shared(ranks) {}
    void declare(CommandLine& line) {
        line.positionals("DEM", heights.files,
                         "heights: georeferenced rasters, or one plain image; @LIST names a file with one name a line")
            .required();
        line.list("--imagery", imagery.files, "FILE", "photos to drape over the heights, or @LIST");
        line.option("--crs", heights.crs, "AUTH:CODE",
                    "metric coordinate system of the dataset; default: the source's, or one chosen");
        line.option("--vertical-crs", verticalCrs, "AUTH:CODE",
                    "what heights are to be above, such as EPSG:5773, or ellipsoid: shifts them from the sources' own "
                    "vertical system (PROJ)");
        line.option("--bbox", bbox, "W,S,E,N", "only this area, metres in the dataset's coordinate system");
        line.option(
            "--priority", priority, "HOW",
            "which file is on top where several overlap: resolution (the finest, the default) or order (the last)");
        line.option("--spacing", heights.spacing, "METRES", "between samples; needed for plain images");
        line.option("--height-scale", heights.heightScale, "S", "metres for one unit of the source, such as 0.3048");
        line.option("--height-offset", heights.heightOffset, "O", "metres to add to all heights");
        line.option("--nodata", heights.nodata, "V", "value of the source that stands for no surface");
        line.option(
            "--fill-nodata", fillNodataText, "HOW",
            "what becomes of samples without data: none (the default, they stay holes), sea (0 m) or interpolate "
            "(from heights within 100 samples)");
        shared.declare(line);
    }
    /// Takes the options' texts apart; refuses what can be refused before any work.
    void check() {
        heights.files = withoutLists(heights.files);
        imagery.files = withoutLists(imagery.files);
        if (!bbox.empty()) heights.bounds = parseBounds(bbox);
        heights.priority = imagery.priority = parsePriority(priority);
        nodataPolicy = parseNodataPolicy(fillNodataText);
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
        if (!verticalCrs.empty()) options.add("--vertical-crs", verticalCrs);
        if (!bbox.empty()) options.add("--bbox", bbox);
        if (heights.priority == MosaicPriority::order) options.add("--priority", priority);
        if (heights.spacing) options.add("--spacing", *heights.spacing);
        if (heights.heightScale) options.add("--height-scale", *heights.heightScale);
        if (heights.heightOffset != 0) options.add("--height-offset", heights.heightOffset);
        if (heights.nodata) options.add("--nodata", *heights.nodata);
        if (nodataPolicy != NodataPolicy::holes) options.add("--fill-nodata", fillNodataText);
        shared.describe(options);
        return options.text();
    }
};

std::unique_ptr<HeightSource> openHeights(const HeightSourceOptions& options) {
    const bool isImage = options.files.size() == 1 && isPlainImage(options.files.front());
    if (isImage && options.bounds)
        throw Error(ExitCode::georeference, "cannot take --bbox out of \"" + options.files.front() +
                                                "\": a plain image does not say where it lies");
    const bool isForGdal = !isImage || isStoredInWideRows(options.files.front(), options.cacheBytes);
    return isForGdal ? openGdalHeights(options) : openImageHeights(options);
}

}  // namespace

ExitCode runBuild(const std::vector<std::string>& arguments, const std::atomic<bool>& stop, Ranks* ranks) {
    BuildOptions options(ranks);
    CommandLine line("terray-preprocess build", "Builds a dataset from height rasters and, if given, photos.");
    options.declare(line);
    if (!line.parse(arguments)) return ExitCode::ok;
    options.check();

    const std::unique_ptr<BuildObserver> observer = makeObserver(options.shared.style());
    options.heights.cacheBytes = cacheShare(options.shared.memoryBytes);
    options.heights.note = [&](const std::string& text) { observer->note(text); };
    std::unique_ptr<HeightSource> source = openHeights(options.heights);
    if (!options.verticalCrs.empty()) source = shiftHeights(std::move(source), options.verticalCrs);
    const std::unique_ptr<HeightSource> heights = fillNodata(std::move(source), options.nodataPolicy);
    OpenPhoto openPhoto;
    options.imagery.cacheBytes = options.heights.cacheBytes;
    if (!options.imagery.files.empty())
        openPhoto = [&](const Tiling& tiling, const HeightGridInfo& info) {
            return openGdalPhotos(options.imagery, tiling, info.size, info.crsWkt);
        };
    BuildRequest request = options.shared.request(options.text(), stop, *observer);
    request.nodataPolicy = nameOf(options.nodataPolicy);
    buildOrEstimate(*heights, openPhoto, request, options.shared);
    return ExitCode::ok;
}

ExitCode runSynth(const std::vector<std::string>& arguments, const std::atomic<bool>& stop, Ranks* ranks) {
    int64_t size = 0;
    double spacing = 1;
    int64_t seed = 1;
    bool imagery = false;
    SharedOptions shared(ranks);
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
    shared.describe(text);
    const SyntheticTerrain terrain{.size = size, .spacing = spacing, .seed = static_cast<uint64_t>(seed)};
    const std::unique_ptr<HeightSource> heights = makeSyntheticHeights(terrain);
    OpenPhoto openPhoto;
    if (imagery)
        openPhoto = [&](const Tiling& tiling, const HeightGridInfo&) { return makeSyntheticPhoto(terrain, tiling); };
    const std::unique_ptr<BuildObserver> observer = makeObserver(shared.style());
    buildOrEstimate(*heights, openPhoto, shared.request(text.text(), stop, *observer), shared);
    return ExitCode::ok;
}

}  // namespace terray
