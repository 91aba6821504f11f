#include "preprocess/block_plan.h"

#include <algorithm>

#include "common/error.h"
#include "common/pmtiles.h"

namespace terray {
namespace {

constexpr uint64_t kMiB = 1u << 20;
/// Levels in a block: 8 x 8 tiles, so the next stage sees 1/64 of the data; a deeper block would take four times the
/// memory.
constexpr uint32_t kMaxDepth = 3;
/// The program, its libraries and the index of blocks: 131 MB are resident before any work, nearly all of it GDAL,
/// OpenImageIO and what these load (Debian 12).
constexpr uint64_t kFixedBytes = 136 * kMiB;
/// One tile being encoded: codes, floats, predictor and compressor.
constexpr uint64_t kTileBufferBytes = 8 * kMiB;

int64_t ceilShift(int64_t value, uint32_t shift) {
    return ((value - 1) >> shift) + 1;
}

int64_t tilesIn(const GridRect& tiles) {
    return tiles.width * tiles.height;
}

/// The largest depth that keeps `jobs` threads busy with two blocks each, as deep as the pyramid allows.
uint32_t busyDepth(const PyramidExtent& extent, int jobs) {
    uint32_t depth = std::min(kMaxDepth, extent.finestLevel);
    while (depth > 1 && tilesIn(extent.coveredTilesAt(extent.finestLevel - depth)) < 2 * int64_t{jobs}) --depth;
    return depth;
}

/// The largest depth up to `depth` of which `jobs` blocks fit; 1 (or 0, for one level) when none does.
uint32_t fittingDepth(uint32_t depth, int jobs, uint64_t budget, uint64_t (*blockBytes)(uint32_t)) {
    while (depth > 1 && blockBytes(depth) * static_cast<uint64_t>(jobs) > budget) --depth;
    return depth;
}

std::string blockText(uint32_t depth) {
    return std::to_string(1u << depth) + " x " + std::to_string(1u << depth);
}

}  // namespace

GridSize PyramidExtent::samplesAt(uint32_t level) const {
    const uint32_t shift = finestLevel - level;
    return {ceilShift(samples.width, shift), ceilShift(samples.height, shift)};
}

GridSize PyramidExtent::tilesAt(uint32_t level) const {
    const GridSize size = samplesAt(level);
    return {(size.width + kTileCore - 1) / kTileCore, (size.height + kTileCore - 1) / kTileCore};
}

GridRect PyramidExtent::coveredTilesAt(uint32_t level) const {
    const GridSize all = tilesAt(level);
    if (!covered) return {0, 0, all.width, all.height};
    const int64_t side = int64_t{kTileCore} << (finestLevel - level);
    const int64_t left = covered->x / side;
    const int64_t top = covered->y / side;
    return {left, top, (covered->x + covered->width - 1) / side + 1 - left,
            (covered->y + covered->height - 1) / side + 1 - top};
}

std::vector<BlockStage> planStages(uint32_t finestLevel, uint32_t depth) {
    if (finestLevel > 0) TERRAY_CHECK_OP(depth, >=, 1u);
    std::vector<BlockStage> stages = {{finestLevel, std::min(depth, finestLevel), true}};
    while (stages.back().top() > 0) {
        const uint32_t bottom = stages.back().top();
        stages.push_back({bottom, std::min(depth, bottom), false});
    }
    return stages;
}

std::vector<TileId> blocksOf(const PyramidExtent& extent, const BlockStage& stage) {
    const GridRect tops = extent.coveredTilesAt(stage.top());
    std::vector<TileId> blocks;
    blocks.reserve(static_cast<size_t>(tilesIn(tops)));
    for (int64_t y = tops.y; y < tops.y + tops.height; ++y)
        for (int64_t x = tops.x; x < tops.x + tops.width; ++x)
            blocks.push_back({stage.top(), static_cast<uint32_t>(x), static_cast<uint32_t>(y)});
    std::ranges::sort(blocks, {}, hilbertId);
    return blocks;
}

GridRect blockWindow(const BlockStage& stage, const TileId& top, int apron) {
    const int64_t side = int64_t{kTileCore} << stage.depth;
    return grown({top.x * side, top.y * side, side, side}, int64_t{apron} << stage.depth);
}

GridRect coreInBlock(const BlockStage& stage, uint32_t above, int apron, int64_t column, int64_t row) {
    const int64_t margin = int64_t{apron} << (stage.depth - above);
    return {margin + column * kTileCore, margin + row * kTileCore, kTileCore, kTileCore};
}

GridRect grown(const GridRect& rect, int64_t margin) {
    return {rect.x - margin, rect.y - margin, rect.width + 2 * margin, rect.height + 2 * margin};
}

uint64_t heightBlockBytes(uint32_t depth) {
    // The finest level holds means alone (4 bytes), those above four floats; levels above sum to 1/3 of the finest.
    const uint64_t side = uint64_t{kHeightTileSide} << depth;
    return side * side * 4 + side * side * 16 / 3 + kTileBufferBytes;
}

uint64_t imageryBlockBytes(uint32_t depth) {
    // The finest level holds 4 bytes a texel, those above four floats; levels above sum to 1/3 of the finest.
    const uint64_t side = uint64_t{kImageryTileSide} << depth;
    return side * side * 4 + side * side * 16 / 3 + kTileBufferBytes;
}

uint64_t cacheShare(uint64_t memoryBytes) {
    return std::clamp(memoryBytes / 8, 32 * kMiB, 256 * kMiB);
}

namespace {

/// Bytes that blocks may take; the memory that remains after the program itself and the reading library's cache.
uint64_t blockBudget(uint64_t memoryBytes) {
    if (memoryBytes < kMinMemoryBytes)
        throw Error(ExitCode::usage, "--memory is " + std::to_string(memoryBytes / kMiB) + " MiB; at least " +
                                         std::to_string(kMinMemoryBytes / kMiB) + " MiB are needed (--memory 256M)");
    return memoryBytes - kFixedBytes - cacheShare(memoryBytes);
}

}  // namespace

WorkPlan planWork(int jobs, uint64_t memoryBytes, const PyramidExtent& heights, const PyramidExtent* imagery,
                  int processes) {
    const uint64_t budget = blockBudget(memoryBytes);
    const uint32_t wanted = busyDepth(heights, jobs * processes);
    const uint32_t heightDepth = fittingDepth(wanted, jobs, budget, heightBlockBytes);
    bool smaller = heightDepth < wanted;
    std::optional<uint32_t> imageryDepth;
    if (imagery != nullptr) {
        const uint32_t wantedImagery = busyDepth(*imagery, jobs * processes);
        imageryDepth = fittingDepth(wantedImagery, jobs, budget, imageryBlockBytes);
        smaller = smaller || *imageryDepth < wantedImagery;
    }
    WorkPlan plan = planResumedWork(jobs, memoryBytes, heightDepth, imageryDepth);
    if (smaller || plan.jobs < jobs)
        plan.note = "to stay within " + std::to_string(memoryBytes / kMiB) + " MiB: blocks of " +
                    blockText(plan.heightDepth) + " height tiles" +
                    (imagery != nullptr ? ", " + blockText(plan.imageryDepth) + " imagery tiles" : "") + ", " +
                    std::to_string(plan.jobs) + " jobs (--memory)";
    return plan;
}

WorkPlan planResumedWork(int jobs, uint64_t memoryBytes, uint32_t heightDepth, std::optional<uint32_t> imageryDepth) {
    WorkPlan plan;
    plan.heightDepth = heightDepth;
    plan.imageryDepth = imageryDepth.value_or(0);
    plan.cacheBytes = cacheShare(memoryBytes);
    uint64_t blockBytes = heightBlockBytes(heightDepth);
    if (imageryDepth) blockBytes = std::max(blockBytes, imageryBlockBytes(*imageryDepth));
    const uint64_t fit = std::max<uint64_t>(blockBudget(memoryBytes) / blockBytes, 1);
    plan.jobs = static_cast<int>(std::min<uint64_t>(static_cast<uint64_t>(jobs), fit));
    return plan;
}

}  // namespace terray
