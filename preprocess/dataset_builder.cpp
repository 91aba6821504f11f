#include "preprocess/dataset_builder.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/error.h"
#include "common/parallel.h"
#include "preprocess/block_team.h"
#include "preprocess/build_context.h"
#include "preprocess/build_heading.h"
#include "preprocess/build_journal.h"
#include "preprocess/build_preparation.h"
#include "preprocess/dataset_archives.h"
#include "preprocess/height_pyramid.h"
#include "preprocess/imagery_pyramid.h"
#include "preprocess/output_directory.h"

namespace terray {
namespace {

/// A build of at least this many tiles takes minutes, so that a second spent on whether its disk will do is well spent.
constexpr uint64_t kManyTiles = 4096;

/// Why a build cannot be gone on with, and what to do.
[[noreturn]] void refuseResume(const std::filesystem::path& out, const std::string& reason) {
    throw Error(ExitCode::usage, "cannot resume the build of " + out.string() + ": " + reason +
                                     "; give what it was begun with, or start it anew, without --resume");
}

/// One build, from sources to a directory with its final name.
class DatasetBuild {
  public:
    DatasetBuild(const HeightSource& heights, const BuildRequest& request, BuildPreparation preparation)
        : heights_(heights),
          request_(request),
          preparation_(std::move(preparation)),
          observer_(request.observer != nullptr ? *request.observer : silent_),
          stop_(request.stop != nullptr ? *request.stop : never_),
          output_(request.out, {.replace = request.replace, .resume = request.resume}),
          team_(request.ranks) {
        summary_.metadata = preparation_.metadata;
    }

    BuildSummary run() {
        if (output_.isPublished()) {
            takeWhole();
            team_.begin({.isWhole = true}, stop_);
        } else {
            BuildJournal journal(output_.journal());
            const WorkPlan work = planOrTakeUp(journal);
            team_.begin({.heading = journal.read(0),
                         .workDirectory = std::filesystem::absolute(output_.workDirectory()),
                         .journal = std::filesystem::absolute(output_.journal())},
                        stop_);
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
        requireSame(preparation_.changesSince(*begun));
        return preparation_.planAsBegun(*begun, request_);
    }

    void requireSame(const std::string& changes) const {
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
        requireSame(preparation_.changesSince(makeHeading(known, 0, 0)));
        observer_.note("there is nothing left to do: " + request_.out.string() + " is whole");
        summary_.metadata = whole;
    }

    void buildTiles(const WorkPlan& work, BuildJournal& journal) {
        DatasetMetadata& metadata = summary_.metadata;
        summary_.jobs = work.jobs;
        summary_.processes = team_.processes();
        BuildContext context{.jobs = work.jobs,
                             .workDirectory = output_.workDirectory(),
                             .stop = stop_,
                             .observer = observer_,
                             .times = times_,
                             .journal = journal,
                             .team = team_,
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
            team_.part(times_, stop_);
            writeArchive(imageryBlocks, kImageryFile, *metadata.imageryLevel);
        } else {
            team_.part(times_, stop_);
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
    BuildPreparation preparation_;
    SilentObserver silent_;
    BuildObserver& observer_;
    std::atomic<bool> never_ = false;
    const std::atomic<bool>& stop_;
    OutputDirectory output_;
    TeamLeader team_;
    BuildTimes times_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    BuildSummary summary_;
};

/// The share of a build that a process has which does not lead.
BuildSummary buildAsMember(const HeightSource& heights, const BuildRequest& request,
                           const BuildPreparation& preparation) {
    const std::atomic<bool> never = false;
    const std::atomic<bool>& stop = request.stop != nullptr ? *request.stop : never;
    TeamMember team(*request.ranks);
    const TeamOrders orders = team.begin(stop);
    if (orders.isWhole) return {};
    const auto begun = decodeHeading(orders.heading);
    if (!begun.ok()) throw Error(ExitCode::usage, begun.failure().message);
    const std::string changes = preparation.changesSince(*begun);
    if (!changes.empty()) throw Error(ExitCode::usage, "sees something else than process 0: " + changes);

    BuildTimes times;
    {
        const WorkPlan work = preparation.planAsBegun(*begun, request);
        SilentObserver observer;
        BuildJournal journal(orders.journal, BuildJournal::Access::follow);
        BuildContext context{.jobs = work.jobs,
                             .workDirectory = orders.workDirectory,
                             .stop = stop,
                             .observer = observer,
                             .times = times,
                             .journal = journal,
                             .team = team,
                             .firstTileDone = [] {}};
        PyramidBlocks heightBlocks(Pyramid::heights, heightExtent(heights.info()), context);
        (void)buildHeightPyramid(heights, work.heightDepth, {preparation.metadata.quantum, request.maxHeightError},
                                 heightBlocks, context);
        if (preparation.photo) {
            PyramidBlocks imageryBlocks(Pyramid::imagery, *preparation.imagery(), context);
            (void)buildImageryPyramid(*preparation.photo, *preparation.imagery(), work.imageryDepth, imageryBlocks,
                                      context);
        }
    }
    team.part(times, stop);
    return {};
}

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
    BuildPreparation preparation(heights, openPhoto, request);
    if (request.ranks != nullptr && request.ranks->rank() != 0) return buildAsMember(heights, request, preparation);
    DatasetBuild build(heights, request, std::move(preparation));
    try {
        return build.run();
    } catch (const Error& error) {
        if (!build.isResumable() || error.code() == ExitCode::usage) throw;
        throw Error(error.code(), std::string(error.what()) + " (what is done is kept in " + request.out.string() +
                                      ".partial; the same command with --resume goes on from there)");
    }
}

BuildEstimate estimateDataset(const HeightSource& heights, const OpenPhoto& openPhoto, const BuildRequest& request) {
    const BuildPreparation preparation(heights, openPhoto, request);
    const WorkPlan work = preparation.plan(heights, request);
    return estimateBuild(preparation.estimateInput(heights, work, request.memoryBytes));
}

}  // namespace terray
