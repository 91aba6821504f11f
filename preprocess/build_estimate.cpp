#include "preprocess/build_estimate.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <optional>

#include "common/error.h"
#include "common/imagery_tile.h"
#include "preprocess/bc1.h"
#include "preprocess/colour_samples.h"
#include "preprocess/height_pyramid.h"
#include "preprocess/height_samples.h"
#include "preprocess/imagery_pyramid.h"
#include "preprocess/progress.h"

namespace terray {
namespace {

/// Tiles looked at along each side of the ground.
constexpr int64_t kProbesAcross = 3;
/// Reading, encoding and writing of a probe leave out halving and the disk; measured builds take this much more.
constexpr double kUnprobedTime = 1.3;

/// What tiles of one pyramid take, summed over the probes.
struct Probes {
    int64_t looked = 0;
    uint64_t bytes = 0;
    double seconds = 0;

    [[nodiscard]] uint64_t bytesOf(uint64_t tiles) const {
        return looked == 0 ? 0
                           : static_cast<uint64_t>(static_cast<double>(bytes) / static_cast<double>(looked) *
                                                   static_cast<double>(tiles));
    }
    [[nodiscard]] double secondsOf(uint64_t tiles) const {
        return looked == 0 ? 0 : seconds / static_cast<double>(looked) * static_cast<double>(tiles);
    }
};

/// Calls probe(tile) for tiles of the finest level in the middles of equal parts of the ground; it returns bytes.
Probes probeTiles(const PyramidExtent& extent, const std::function<uint64_t(const TileId&)>& probe) {
    const GridRect tiles = extent.coveredTilesAt(extent.finestLevel);
    const int64_t across = std::min(kProbesAcross, tiles.width);
    const int64_t down = std::min(kProbesAcross, tiles.height);
    Probes probes;
    const auto start = std::chrono::steady_clock::now();
    for (int64_t row = 0; row < down; ++row)
        for (int64_t column = 0; column < across; ++column) {
            const int64_t x = tiles.x + (2 * column + 1) * tiles.width / (2 * across);
            const int64_t y = tiles.y + (2 * row + 1) * tiles.height / (2 * down);
            probes.bytes += probe({extent.finestLevel, static_cast<uint32_t>(x), static_cast<uint32_t>(y)});
            ++probes.looked;
        }
    probes.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return probes;
}

uint64_t probeHeights(HeightReader& reader, const TileId& id, double quantum) {
    const GridRect core = Tiling::coreSamples(id);
    Grid<float> heights({kHeightTileSide, kHeightTileSide});
    reader.read(grown(core, kHeightApron), heights.view());
    const GridView<const float> inner =
        std::as_const(heights).view().window({kHeightApron, kHeightApron, kTileCore, kTileCore});
    const auto tile = makeHeightTile(
        {.id = id, .mean = heights.view(), .core = {inner, inner, inner}, .quantum = quantum, .children = {}});
    return tile ? encodeHeightTile(*tile).size() : 0;
}

uint64_t probeImagery(ColourReader& reader, const TileId& id) {
    Grid<Rgba> texels({kImageryTileSide, kImageryTileSide});
    reader.read(grown(Tiling::coreSamples(id), kImageryGutter), texels.view());
    if (!anyPhoto(texels.view())) return 0;
    ImageryTile tile;
    tile.id = id;
    tile.blocks = encodeBc1(shownColours(std::as_const(texels).view()).view());
    return encodeImageryTile(tile).size();
}

/// Bytes of the level between the first two stages.
uint64_t levelBytes(const PyramidExtent& extent, uint32_t depth, uint64_t sampleBytes) {
    if (depth >= extent.finestLevel) return 0;
    const GridRect tiles = extent.coveredTilesAt(extent.finestLevel - depth);
    return static_cast<uint64_t>(tiles.width * tiles.height) * kTileCore * kTileCore * sampleBytes;
}

}  // namespace

uint64_t tilesOf(const PyramidExtent& extent) {
    uint64_t tiles = 0;
    for (uint32_t level = 0; level <= extent.finestLevel; ++level) {
        const GridRect covered = extent.coveredTilesAt(level);
        tiles += static_cast<uint64_t>(covered.width * covered.height);
    }
    return tiles;
}

BuildEstimate estimateBuild(const EstimateInput& input) {
    constexpr uint64_t kHeightSampleBytes = 16;
    constexpr uint64_t kTexelBytes = 16;
    BuildEstimate estimate;
    estimate.jobs = input.work.jobs;
    estimate.memoryBytes = input.memoryBytes;

    const PyramidExtent heights = heightExtent(input.heights.info());
    estimate.heightTiles = tilesOf(heights);
    const std::unique_ptr<HeightReader> heightReader = input.heights.openReader();
    const Probes heightProbes =
        probeTiles(heights, [&](const TileId& id) { return probeHeights(*heightReader, id, input.quantum); });
    const uint64_t heightBytes = heightProbes.bytesOf(estimate.heightTiles);
    double seconds = heightProbes.secondsOf(estimate.heightTiles);
    // Tiles lie on the disk twice while they become an archive; before that there is the level between two stages.
    const uint64_t heightStage =
        heightBytes + input.heights.preparedBytes() + levelBytes(heights, input.work.heightDepth, kHeightSampleBytes);
    uint64_t imageryBytes = 0;
    uint64_t imageryStage = 0;
    if (input.photo != nullptr) {
        const PyramidExtent imagery = imageryExtent(input.tiling, input.heights.info().size, *input.photo);
        estimate.imageryTiles = tilesOf(imagery);
        const std::unique_ptr<ColourReader> photoReader = input.photo->openReader();
        const Probes photoProbes =
            probeTiles(imagery, [&](const TileId& id) { return probeImagery(*photoReader, id); });
        imageryBytes = photoProbes.bytesOf(estimate.imageryTiles);
        seconds += photoProbes.secondsOf(estimate.imageryTiles);
        const uint64_t level = levelBytes(imagery, input.work.imageryDepth, kTexelBytes);
        imageryStage = heightBytes + imageryBytes + std::max(imageryBytes, level + input.photo->preparedBytes());
    }
    estimate.archiveBytes = heightBytes + imageryBytes;
    estimate.diskBytes = std::max({heightStage, imageryStage, 2 * heightBytes + imageryBytes});
    estimate.seconds = kUnprobedTime * seconds / std::max(1, input.work.jobs);
    return estimate;
}

void requireSpace(const BuildEstimate& estimate, const std::filesystem::path& out) {
    std::error_code error;
    const uint64_t free = std::filesystem::space(std::filesystem::absolute(out).parent_path(), error).available;
    if (error || free >= estimate.diskBytes / 5 * 4) return;
    throw Error(ExitCode::output, "cannot build " + out.string() + ": about " + readableBytes(estimate.diskBytes) +
                                      " are needed while it is built, and " + readableBytes(free) +
                                      " are free there; free some space, or choose another --out");
}

std::string toText(const BuildEstimate& estimate, const std::filesystem::path& out) {
    std::error_code error;
    const uint64_t free = std::filesystem::space(std::filesystem::absolute(out).parent_path(), error).available;
    std::array<char, 80> time{};
    std::snprintf(time.data(), time.size(), "time: about %.0f s on %d jobs\n", estimate.seconds, estimate.jobs);
    return "tiles: at most " + std::to_string(estimate.heightTiles) + " of heights, " +
           std::to_string(estimate.imageryTiles) + " of imagery\narchives: about " +
           readableBytes(estimate.archiveBytes) + "\ndisk: about " + readableBytes(estimate.diskBytes) +
           " at its fullest" + (error ? "" : ", " + readableBytes(free) + " are free") + "\nmemory: at most " +
           readableBytes(estimate.memoryBytes) + "\n" + time.data();
}

}  // namespace terray
