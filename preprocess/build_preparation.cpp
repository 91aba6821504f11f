#include "preprocess/build_preparation.h"

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/version.h"
#include "preprocess/bc1.h"
#include "preprocess/height_pyramid.h"
#include "preprocess/imagery_pyramid.h"
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

}  // namespace

BuildPreparation::BuildPreparation(const HeightSource& heights, const OpenPhoto& openPhoto,
                                   const BuildRequest& request) {
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

std::optional<PyramidExtent> BuildPreparation::imagery() const {
    if (!photo) return {};
    return imageryExtent(metadata.tiling, metadata.samples, *photo);
}

WorkPlan BuildPreparation::plan(const HeightSource& heights, const BuildRequest& request) const {
    const std::optional<PyramidExtent> extent = imagery();
    const int processes = request.ranks != nullptr ? request.ranks->count() : 1;
    WorkPlan work = planWork(request.jobs, request.memoryBytes, heightExtent(heights.info()),
                             extent ? &*extent : nullptr, processes);
    work.heightDepth = request.blockDepth.value_or(work.heightDepth);
    work.imageryDepth = request.blockDepth.value_or(work.imageryDepth);
    return work;
}

WorkPlan BuildPreparation::planAsBegun(const BuildHeading& begun, const BuildRequest& request) const {
    std::optional<uint32_t> imageryDepth;
    if (photo) imageryDepth = begun.imageryDepth;
    return planResumedWork(request.jobs, request.memoryBytes, begun.heightDepth, imageryDepth);
}

EstimateInput BuildPreparation::estimateInput(const HeightSource& heights, const WorkPlan& work,
                                              uint64_t memoryBytes) const {
    return {.heights = heights,
            .photo = photo.get(),
            .tiling = metadata.tiling,
            .quantum = metadata.quantum,
            .work = work,
            .memoryBytes = memoryBytes};
}

std::string BuildPreparation::changesSince(const BuildHeading& begun) const {
    std::string changes;
    for (const std::string& change : terray::changesSince(begun, makeHeading(metadata, 0, 0)))
        changes += (changes.empty() ? "" : "; ") + change;
    return changes;
}

void BuildPreparation::requireOverlap() const {
    if (!overlapOf(photo->bounds(), metadata.groundBounds()))
        throw Error(ExitCode::georeference, "heights and imagery do not overlap");
    if (photo->level() > kMaxTileLevel)
        throw Error(ExitCode::input, "the imagery is too fine for the heights: more than 31 levels are needed");
}

}  // namespace terray
