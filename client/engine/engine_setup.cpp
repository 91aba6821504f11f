#include "client/engine/engine_setup.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/stream/host_cache.h"

namespace terray {
namespace {

/// Tiles that are asked for or wait for upload at a time, at most: about 34 MB of heights. More than a frame uploads by
/// default, so reader and decoders stay busy; few enough that refinement follows the most urgent tiles.
constexpr size_t kMaxPendingTiles = 64;

bool usesImagery(const TileSource& source, const EngineOptions& options) {
    return options.selection.useImagery && source.metadata().imageryLevel.has_value() &&
           needsOf(options.render.shading.mode).photoTiles;
}

/// What the mode measures by, where the caller has not said: the dataset's heights, and the selection's tolerance.
void settleShading(ShadingOptions& shading, const DatasetMetadata& metadata, Pixels tolerance) {
    shading.lowest = Metres(metadata.minHeight);
    shading.highest = Metres(metadata.maxHeight);
    if (shading.contourInterval == Metres(0))
        shading.contourInterval = automaticContourInterval(shading.lowest, shading.highest);
    shading.tolerance = tolerance;
}

/// The greatest drop per squared metre over the middle of the dataset; it changes by parts in 100 over the largest.
double greatestBend(const EarthModel& earth, const DatasetMetadata& metadata) {
    const GroundRect ground = metadata.groundBounds();
    const auto bend = earth.at({(ground.west + ground.east) / 2, (ground.south + ground.north) / 2, 0});
    return bend ? std::max(bend->xx, bend->yy) + std::abs(bend->xy) / 2 : 0;
}

}  // namespace

EngineOptions settled(EngineOptions options, const TileSource& source) {
    options.features.imagery = options.selection.useImagery = usesImagery(source, options);
    settleShading(options.render.shading, source.metadata(), options.selection.tolerance);
    const ShadingNeeds needs = needsOf(options.render.shading.mode);
    options.features.statistics |= needs.steps || needs.shadowSteps;
    options.render.sky &= needs.sky;
    if (!needs.light) options.render.visualRange.reset();
    if (!needs.light && !needs.shadowSteps) options.render.shadows.reset();
    return options;
}

EarthModel earthOf(const DatasetMetadata& metadata, const EngineOptions& options, int width, int height) {
    return {metadata, options.earth, options.selection.tolerance.value(),
            viewOf(Camera(), width, height).focalPixels()};
}

std::optional<SunClock> clockOf(const DatasetMetadata& metadata, const EngineOptions& options) {
    if (!options.sunTime) return {};
    return std::optional<SunClock>(std::in_place, *options.sunTime, metadata);
}

GpuTilesOptions slotOptions(const TileSource& source, const EngineOptions& options, const EarthModel& earth) {
    const bool imagery = usesImagery(source, options);
    return {.heightBudgetBytes = options.gpuHeightBytes,
            .imageryBudgetBytes = imagery ? options.gpuImageryBytes : 0,
            .heightTiles = source.metadata().heightTiles,
            .imageryTiles = imagery ? source.metadata().imageryTiles : 0,
            .method = {.method = options.render.method,
                       .tiling = source.metadata().tiling,
                       .earthBend = greatestBend(earth, source.metadata())},
            .measurePreparation = options.measurePreparation};
}

uint64_t pendingTileBytes() {
    return hostBytesOf({TileLayer::heights, {}});
}

size_t mostPendingTiles(uint64_t hostBudgetBytes) {
    return static_cast<size_t>(std::clamp<uint64_t>(hostBudgetBytes / 4 / pendingTileBytes(), 1, kMaxPendingTiles));
}

PagerOptions withoutPending(PagerOptions options) {
    const uint64_t pending = mostPendingTiles(options.hostBudgetBytes) * pendingTileBytes();
    options.hostBudgetBytes -= std::min(options.hostBudgetBytes, pending);
    return options;
}

size_t tilesBesideRoot(uint32_t slots, uint64_t tiles) {
    if (slots >= tiles) return std::numeric_limits<size_t>::max();
    return slots > 2 ? slots - 2 : 0;
}

}  // namespace terray
