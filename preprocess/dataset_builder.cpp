#include "preprocess/dataset_builder.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/error.h"
#include "common/parallel.h"
#include "common/version.h"
#include "preprocess/bc1.h"
#include "preprocess/build_context.h"
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
    metadata.quantum = request.quantum.value_or(chooseQuantum(info));
    metadata.tool = "terray-preprocess " + std::string(buildInfo().version);
    metadata.options = request.optionsText;
    metadata.sources = info.files;
    return metadata;
}

/// One build, from sources to a directory with its final name.
class DatasetBuild {
  public:
    DatasetBuild(const HeightSource& heights, const BuildRequest& request)
        : heights_(heights),
          request_(request),
          observer_(request.observer != nullptr ? *request.observer : silent_),
          stop_(request.stop != nullptr ? *request.stop : never_),
          output_(request.out, request.replace) {
        const HeightGridInfo& info = heights.info();
        const Tiling tiling{.west = info.west,
                            .north = info.north,
                            .finestSpacing = info.spacing,
                            .finestLevel = Tiling::levelFor(std::max(info.size.width, info.size.height))};
        summary_.metadata = describe(info, tiling, request);
    }

    BuildSummary run(const OpenPhoto& openPhoto) {
        DatasetMetadata& metadata = summary_.metadata;
        std::unique_ptr<ColourSource> photo;
        if (openPhoto) {
            requireBc1Encoder();
            photo = openPhoto(metadata.tiling, heights_.info());
            requireOverlap(*photo);
            metadata.imageryLevel = photo->level();
            metadata.imageryBounds = overlapOf(photo->bounds(), metadata.groundBounds());
            metadata.sources.insert(metadata.sources.end(), photo->files().begin(), photo->files().end());
        }
        buildTiles(photo.get());
        throwIfStopped(stop_);
        output_.commit();
        finishSummary();
        return std::move(summary_);
    }

  private:
    void requireOverlap(const ColourSource& photo) const {
        if (!overlapOf(photo.bounds(), summary_.metadata.groundBounds()))
            throw Error(ExitCode::georeference, "heights and imagery do not overlap");
        if (photo.level() > kMaxTileLevel)
            throw Error(ExitCode::input, "the imagery is too fine for the heights: more than 31 levels are needed");
    }

    [[nodiscard]] WorkPlan plan(const ColourSource* photo) const {
        const PyramidExtent heights{summary_.metadata.tiling.finestLevel, summary_.metadata.samples};
        if (photo == nullptr) return planWork(request_.jobs, request_.memoryBytes, heights, nullptr);
        const PyramidExtent imagery =
            imageryExtent(summary_.metadata.tiling, summary_.metadata.samples, photo->level());
        return planWork(request_.jobs, request_.memoryBytes, heights, &imagery);
    }

    void buildTiles(const ColourSource* photo) {
        DatasetMetadata& metadata = summary_.metadata;
        const WorkPlan work = plan(photo);
        if (!work.note.empty()) observer_.note(work.note);
        summary_.jobs = work.jobs;
        BuildContext context{.jobs = work.jobs,
                             .workDirectory = output_.workDirectory(),
                             .stop = stop_,
                             .observer = observer_,
                             .times = times_};

        TileSpill heightTiles(output_.workDirectory() / "height-tiles");
        const HeightTotals totals = buildHeightPyramid(heights_, request_.blockDepth.value_or(work.heightDepth),
                                                       metadata.quantum, heightTiles, context);
        metadata.heightTiles = totals.tiles;
        metadata.holeSamples = totals.holeSamples;
        metadata.minHeight = totals.minHeight;
        metadata.maxHeight = totals.maxHeight;
        metadata.levelErrors = totals.levelErrors;
        if (photo != nullptr) {
            TileSpill imageryTiles(output_.workDirectory() / "imagery-tiles");
            metadata.imageryTiles =
                buildImageryPyramid(*photo, metadata.tiling, metadata.samples,
                                    request_.blockDepth.value_or(work.imageryDepth), imageryTiles, context);
            writeArchive(imageryTiles, kImageryFile, *metadata.imageryLevel);
        }
        writeArchive(heightTiles, kHeightsFile, metadata.tiling.finestLevel);
    }

    void writeArchive(TileSpill& tiles, const char* name, uint32_t finestLevel) {
        throwIfStopped(stop_);
        observer_.stageBegins(std::string("writing ") + name, 1);
        {
            const StepTimer timer(times_, BuildStep::write);
            PmtilesWriter writer(output_.directory() / name);
            tiles.writeTo(writer, stop_);
            writer.finish(toJson(summary_.metadata).dump(), archiveHeader(summary_.metadata, finestLevel));
        }
        observer_.blockDone(summary_.metadata.heightTiles + summary_.metadata.imageryTiles, tiles.bytes());
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
    requireUsable(heights.info());
    return DatasetBuild(heights, request).run(openPhoto);
}

}  // namespace terray
