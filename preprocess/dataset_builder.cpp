#include "preprocess/dataset_builder.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/error.h"
#include "common/parallel.h"
#include "common/version.h"
#include "preprocess/bc1.h"
#include "preprocess/build_context.h"
#include "preprocess/build_estimate.h"
#include "preprocess/build_heading.h"
#include "preprocess/build_journal.h"
#include "preprocess/dataset_archives.h"
#include "preprocess/height_pyramid.h"
#include "preprocess/imagery_pyramid.h"
#include "preprocess/output_directory.h"
#include "preprocess/raster_layout.h"

namespace terray {
namespace {

/// Deepest finest level that a build takes on: 2^29 samples along a side, the earth at 7 cm.
constexpr uint32_t kMaxFinestLevel = 20;

void requireUsable(const HeightGridInfo& info) {
    if (info.size.width < 1 || info.size.height < 1)
        throw Error(ExitCode::input, "the source is empty: " + std::to_string(info.size.width) + " x " +
                                         std::to_string(info.size.height) + " samples");
    if (!(info.spacing > 0) || !std::isfinite(info.spacing))
        throw Error(ExitCode::input,
                    "the source's spacing is " + std::to_string(info.spacing) + " m; it must be above 0");
    if (Tiling::levelFor(std::max(info.size.width, info.size.height)) > kMaxFinestLevel)
        throw Error(ExitCode::input, "the source has " + std::to_string(info.size.width) + " x " +
                                         std::to_string(info.size.height) +
                                         " samples; at most 2^29 along a side are "
                                         "supported");
}

/// Compresses one block, so that a build without encoder fails now and not after hours of work on the heights.
void requireBc1Encoder() {
    (void)encodeBc1(Grid<Rgba>({4, 4}).view());
}

DatasetMetadata describe(const HeightGridInfo& info, const Tiling& tiling, const BuildRequest& request) {
    DatasetMetadata metadata;
    metadata.tiling = tiling;
    metadata.samples = info.size;
    metadata.crsWkt = info.crsWkt;
    metadata.crsName = info.crsName;
    metadata.lonLatBounds = info.lonLatBounds;
    metadata.verticalDatum = info.verticalDatum;
    metadata.quantum =
        request.quantum.value_or(request.maxHeightError ? 2 * *request.maxHeightError : chooseQuantum(info));
    metadata.tool = "terray-preprocess " + std::string(buildInfo().version);
    metadata.options = request.optionsText;
    metadata.nodataPolicy = request.nodataPolicy;
    metadata.sources = info.files;
    return metadata;
}

/// A build of at least this many tiles takes minutes, so that a second spent on whether its disk will do is well spent.
constexpr uint64_t kManyTiles = 4096;

/// What is known before any block is made.
struct Preparation {
    DatasetMetadata metadata;  ///< without what only the build itself finds out
    std::unique_ptr<ColourSource> photo;

    Preparation(const HeightSource& heights, const OpenPhoto& openPhoto, const BuildRequest& request) {
        const HeightGridInfo& info = heights.info();
        requireUsable(info);
        const Tiling tiling{.west = info.west,
                            .north = info.north,
                            .finestSpacing = info.spacing,
                            .finestLevel = heightExtent(info).finestLevel};
        metadata = describe(info, tiling, request);
        if (!openPhoto) return;
        requireBc1Encoder();
        photo = openPhoto(tiling, info);
        requireOverlap();
        metadata.imageryLevel = photo->level();
        metadata.imageryBounds = overlapOf(photo->bounds(), metadata.groundBounds());
        metadata.sources.insert(metadata.sources.end(), photo->files().begin(), photo->files().end());
    }

    [[nodiscard]] std::optional<PyramidExtent> imagery() const {
        if (!photo) return {};
        return imageryExtent(metadata.tiling, metadata.samples, *photo);
    }

    [[nodiscard]] WorkPlan plan(const HeightSource& heights, const BuildRequest& request) const {
        const std::optional<PyramidExtent> extent = imagery();
        WorkPlan work =
            planWork(request.jobs, request.memoryBytes, heightExtent(heights.info()), extent ? &*extent : nullptr);
        work.heightDepth = request.blockDepth.value_or(work.heightDepth);
        work.imageryDepth = request.blockDepth.value_or(work.imageryDepth);
        return work;
    }

    [[nodiscard]] EstimateInput estimateInput(const HeightSource& heights, const WorkPlan& work,
                                              uint64_t memoryBytes) const {
        return {.heights = heights,
                .photo = photo.get(),
                .tiling = metadata.tiling,
                .quantum = metadata.quantum,
                .work = work,
                .memoryBytes = memoryBytes};
    }

  private:
    void requireOverlap() const {
        if (!overlapOf(photo->bounds(), metadata.groundBounds()))
            throw Error(ExitCode::georeference, "heights and imagery do not overlap");
        if (photo->level() > kMaxTileLevel)
            throw Error(ExitCode::input, "the imagery is too fine for the heights: more than 31 levels are needed");
    }
};

/// Why a build cannot be gone on with, and what to do.
[[noreturn]] void refuseResume(const std::filesystem::path& out, const std::string& reason) {
    throw Error(ExitCode::usage, "cannot resume the build of " + out.string() + ": " + reason +
                                     "; give what it was begun with, or start it anew, without --resume");
}

/// One build, from sources to a directory with its final name.
class DatasetBuild {
  public:
    DatasetBuild(const HeightSource& heights, const BuildRequest& request, Preparation preparation)
        : heights_(heights),
          request_(request),
          preparation_(std::move(preparation)),
          observer_(request.observer != nullptr ? *request.observer : silent_),
          stop_(request.stop != nullptr ? *request.stop : never_),
          output_(request.out, {.replace = request.replace, .resume = request.resume}) {
        summary_.metadata = preparation_.metadata;
    }

    BuildSummary run() {
        if (output_.isPublished()) {
            takeWhole();
        } else {
            BuildJournal journal(output_.journal());
            const WorkPlan work = planOrTakeUp(journal);
            buildTiles(work, journal);
        }
        throwIfStopped(stop_);
        output_.commit();
        finishSummary();
        return std::move(summary_);
    }

    [[nodiscard]] bool isResumable() const { return output_.isKept(); }

  private:
    /// The plan of a build that begins, which goes into the journal, or of one that is gone on with.
    WorkPlan planOrTakeUp(BuildJournal& journal) {
        if (!journal.empty()) return takeUp(journal);
        if (request_.resume) observer_.note("there is nothing to resume: the build starts from the beginning");
        WorkPlan work = preparation_.plan(heights_, request_);
        if (!work.note.empty()) observer_.note(work.note);
        if (tilesOf(heightExtent(heights_.info())) + tilesOf(preparation_.imagery().value_or(PyramidExtent{})) >=
            kManyTiles)
            requireSpace(estimateBuild(preparation_.estimateInput(heights_, work, request_.memoryBytes)), request_.out);
        journal.commit(encodeHeading(makeHeading(summary_.metadata, work.heightDepth, work.imageryDepth)), {});
        journal.sync();
        return work;
    }

    WorkPlan takeUp(BuildJournal& journal) const {
        const auto begun = decodeHeading(journal.read(0));
        if (!begun.ok()) refuseResume(request_.out, begun.failure().message);
        requireSame(*begun);
        std::optional<uint32_t> imageryDepth;
        if (preparation_.photo) imageryDepth = begun->imageryDepth;
        return planResumedWork(request_.jobs, request_.memoryBytes, begun->heightDepth, imageryDepth);
    }

    void requireSame(const BuildHeading& begun) const {
        std::string changes;
        for (const std::string& change : changesSince(begun, makeHeading(summary_.metadata, 0, 0)))
            changes += (changes.empty() ? "" : "; ") + change;
        if (!changes.empty()) refuseResume(request_.out, changes);
    }

    /// For a dataset that is whole already, if it is the one asked for.
    void takeWhole() {
        const DatasetMetadata whole = openDataset(request_.out).metadata;
        DatasetMetadata known = whole;
        const DatasetMetadata unbuilt;
        known.heightTiles = unbuilt.heightTiles;
        known.imageryTiles = unbuilt.imageryTiles;
        known.holeSamples = unbuilt.holeSamples;
        known.minHeight = unbuilt.minHeight;
        known.maxHeight = unbuilt.maxHeight;
        known.levelErrors = unbuilt.levelErrors;
        known.errorBound = unbuilt.errorBound;
        requireSame(makeHeading(known, 0, 0));
        observer_.note("there is nothing left to do: " + request_.out.string() + " is whole");
        summary_.metadata = whole;
    }

    void buildTiles(const WorkPlan& work, BuildJournal& journal) {
        DatasetMetadata& metadata = summary_.metadata;
        summary_.jobs = work.jobs;
        BuildContext context{.jobs = work.jobs,
                             .workDirectory = output_.workDirectory(),
                             .stop = stop_,
                             .observer = observer_,
                             .times = times_,
                             .journal = journal,
                             .firstTileDone = [this] { output_.keep(true); }};

        PyramidBlocks heightBlocks(Pyramid::heights, heightExtent(heights_.info()), context);
        const HeightTotals totals = buildHeightPyramid(
            heights_, work.heightDepth, {metadata.quantum, request_.maxHeightError}, heightBlocks, context);
        metadata.heightTiles = totals.tiles;
        metadata.holeSamples = totals.holeSamples;
        metadata.minHeight = totals.minHeight;
        metadata.maxHeight = totals.maxHeight;
        metadata.levelErrors = totals.levelErrors;
        metadata.errorBound = totals.finestStep / 2;
        if (preparation_.photo) {
            PyramidBlocks imageryBlocks(Pyramid::imagery, *preparation_.imagery(), context);
            buildImagery(work, imageryBlocks, context);
            writeArchive(imageryBlocks, kImageryFile, *metadata.imageryLevel);
        }
        writeArchive(heightBlocks, kHeightsFile, metadata.tiling.finestLevel);
    }

    void buildImagery(const WorkPlan& work, PyramidBlocks& blocks, BuildContext& context) {
        DatasetMetadata& metadata = summary_.metadata;
        try {
            metadata.imageryTiles =
                buildImageryPyramid(*preparation_.photo, *preparation_.imagery(), work.imageryDepth, blocks, context);
        } catch (const Error& error) {
            // No texel over the heights: that is so however often it is tried.
            if (error.code() == ExitCode::georeference) output_.keep(false);
            throw;
        }
    }

    void writeArchive(PyramidBlocks& blocks, const char* name, uint32_t finestLevel) {
        throwIfStopped(stop_);
        observer_.stageBegins(std::string("writing ") + name, 1, 0);
        // An archive that has its name is whole, if an earlier run gave it that.
        if (!std::filesystem::exists(output_.directory() / name)) {
            const StepTimer timer(times_, BuildStep::write);
            writePmtiles(output_.directory() / name, toJson(summary_.metadata).dump(),
                         archiveHeader(summary_.metadata, finestLevel), blocks.contents());
        }
        blocks.discard();
        observer_.blockDone(summary_.metadata.heightTiles + summary_.metadata.imageryTiles, blocks.bytes());
    }

    void finishSummary() {
        summary_.heightBytes = std::filesystem::file_size(request_.out / kHeightsFile);
        if (summary_.metadata.imageryLevel)
            summary_.imageryBytes = std::filesystem::file_size(request_.out / kImageryFile);
        for (size_t step = 0; step < kBuildStepNames.size(); ++step)
            summary_.stepSeconds[step] = times_.seconds(static_cast<BuildStep>(step));
        summary_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

    const HeightSource& heights_;
    const BuildRequest& request_;
    Preparation preparation_;
    SilentObserver silent_;
    BuildObserver& observer_;
    std::atomic<bool> never_ = false;
    const std::atomic<bool>& stop_;
    OutputDirectory output_;
    BuildTimes times_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    BuildSummary summary_;
};

}  // namespace

double chooseQuantum(const HeightGridInfo& heights) {
    constexpr double kCentimetre = 0.01;
    constexpr double kMillimetre = 0.001;
    const double steps = heights.sourceStep / kCentimetre;
    const bool inCentimetres = heights.sourceStep > 0 && std::abs(steps - std::round(steps)) < 1e-6;
    return heights.spacing <= 0.5 && !inCentimetres ? kMillimetre : kCentimetre;
}

PmtilesHeader archiveHeader(const DatasetMetadata& metadata, uint32_t finestLevel) {
    const GroundRect bounds = metadata.lonLatBounds.value_or(GroundRect{-180, -90, 180, 90});
    PmtilesHeader header;
    header.minZoom = 0;
    header.maxZoom = static_cast<uint8_t>(finestLevel);
    header.minLon = bounds.west;
    header.minLat = bounds.south;
    header.maxLon = bounds.east;
    header.maxLat = bounds.north;
    header.centerZoom = 0;
    // Across the antimeridian west > east, and the mean of the two would lie on the other side of the earth.
    const double east = bounds.east < bounds.west ? bounds.east + 360 : bounds.east;
    header.centerLon = std::remainder((bounds.west + east) / 2, 360.0);
    header.centerLat = (bounds.south + bounds.north) / 2;
    return header;
}

BuildSummary buildDataset(const HeightSource& heights, const OpenPhoto& openPhoto, const BuildRequest& request) {
    DatasetBuild build(heights, request, Preparation(heights, openPhoto, request));
    try {
        return build.run();
    } catch (const Error& error) {
        if (!build.isResumable() || error.code() == ExitCode::usage) throw;
        throw Error(error.code(), std::string(error.what()) + " (what is done is kept in " + request.out.string() +
                                      ".partial; the same command with --resume goes on from there)");
    }
}

BuildEstimate estimateDataset(const HeightSource& heights, const OpenPhoto& openPhoto, const BuildRequest& request) {
    const Preparation preparation(heights, openPhoto, request);
    const WorkPlan work = preparation.plan(heights, request);
    return estimateBuild(preparation.estimateInput(heights, work, request.memoryBytes));
}

}  // namespace terray
