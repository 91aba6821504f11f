#include "preprocess/block_plan.h"

#include <set>

#include <gtest/gtest.h>

#include "common/error.h"

namespace terray {
namespace {

constexpr uint64_t kMiB = 1u << 20;

TEST(BlockPlan, ExtentsRoundUpToWholeCellsAndTiles) {
    const PyramidExtent extent{.finestLevel = 2, .samples = {1025, 37}};
    EXPECT_EQ(extent.samplesAt(2), (GridSize{1025, 37}));
    EXPECT_EQ(extent.samplesAt(1), (GridSize{513, 19}));
    EXPECT_EQ(extent.samplesAt(0), (GridSize{257, 10}));
    EXPECT_EQ(extent.tilesAt(2), (GridSize{3, 1}));
    EXPECT_EQ(extent.tilesAt(1), (GridSize{2, 1}));
    EXPECT_EQ(extent.tilesAt(0), (GridSize{1, 1}));
}

TEST(BlockPlan, BlocksLieWhereTheSourceIs) {
    // A photo of 3000 x 1000 texels of 1 mm, on ground of 100 km: 2^18 tiles a side.
    const PyramidExtent extent{18, {int64_t{512} << 18, int64_t{512} << 18}, GridRect{50000000, 70000000, 3000, 1000}};
    EXPECT_EQ(extent.coveredTilesAt(18), (GridRect{97656, 136718, 7, 3}));
    EXPECT_EQ(extent.coveredTilesAt(0), (GridRect{0, 0, 1, 1}));
    for (const BlockStage& stage : planStages(18, 3)) EXPECT_LE(blocksOf(extent, stage).size(), 2u);
}

TEST(BlockPlan, StagesMakeEveryLevelOnce) {
    for (uint32_t finest = 0; finest <= 12; ++finest) {
        for (uint32_t depth = 1; depth <= 4; ++depth) {
            uint32_t expected = finest;
            for (const BlockStage& stage : planStages(finest, depth)) {
                EXPECT_EQ(stage.bottom, expected);
                EXPECT_LE(stage.depth, depth);
                EXPECT_EQ(stage.first, stage.bottom == finest);
                expected = stage.top();
            }
            EXPECT_EQ(expected, 0u);
        }
    }
}

TEST(BlockPlan, BlocksCoverTheLevelOnceAlongTheCurve) {
    const PyramidExtent extent{.finestLevel = 5, .samples = {16384, 5000}};
    const BlockStage stage{.bottom = 5, .depth = 2};
    const std::vector<TileId> blocks = blocksOf(extent, stage);
    EXPECT_EQ(std::set<TileId>(blocks.begin(), blocks.end()).size(), 8u * 3);
    EXPECT_EQ(blocks.size(), 8u * 3);
    EXPECT_EQ(blocks.front(), (TileId{3, 0, 0}));
}

TEST(BlockPlan, WindowsHoldEveryTileOfEveryLevelWithItsApron) {
    const BlockStage stage{.bottom = 7, .depth = 3};
    const TileId top{4, 2, 1};
    const GridRect window = blockWindow(stage, top, 2);
    EXPECT_EQ(window, (GridRect{2 * 4096 - 16, 4096 - 16, 4096 + 32, 4096 + 32}));
    for (uint32_t above = 0; above <= 3; ++above) {
        const int64_t last = (8 >> above) - 1;
        EXPECT_GE(grown(coreInBlock(stage, above, 2, 0, 0), 2).x, 0);
        const GridRect east = grown(coreInBlock(stage, above, 2, last, last), 2);
        EXPECT_LE(east.x + east.width, window.width >> above);
        // The first core sample of the block is the first one of its first tile in the level's own numbers.
        EXPECT_EQ((window.x >> above) + coreInBlock(stage, above, 2, 0, 0).x,
                  Tiling::coreSamples(top).x << (3 - above));
    }
}

TEST(BlockPlan, MemoryBoundsBlocksTimesJobs) {
    const PyramidExtent heights{.finestLevel = 9, .samples = {200000, 200000}};
    const PyramidExtent imagery{.finestLevel = 10, .samples = {400000, 400000}};
    for (const uint64_t memory : {256 * kMiB, 300 * kMiB, 512 * kMiB, 2048 * kMiB, 65536 * kMiB}) {
        for (const int jobs : {1, 2, 16, 128}) {
            const WorkPlan plan = planWork(jobs, memory, heights, &imagery);
            EXPECT_GE(plan.jobs, 1);
            EXPECT_LE(plan.jobs, jobs);
            EXPECT_GE(plan.heightDepth, 1u);
            EXPECT_LE(plan.heightDepth, 3u);
            const uint64_t block = std::max(heightBlockBytes(plan.heightDepth), imageryBlockBytes(plan.imageryDepth));
            EXPECT_LE(plan.cacheBytes + block * static_cast<uint64_t>(plan.jobs), memory);
            EXPECT_EQ(plan.note.empty(), plan.jobs == jobs && plan.heightDepth == 3 && plan.imageryDepth == 3);
        }
    }
    EXPECT_EQ(planWork(2, 2048 * kMiB, heights, nullptr).heightDepth, 3u);
    EXPECT_EQ(planWork(16, 65536 * kMiB, heights, &imagery).jobs, 16);
}

TEST(BlockPlan, SmallRastersAreCutIntoEnoughBlocksForAllJobs) {
    const PyramidExtent heights{.finestLevel = 3, .samples = {2401, 1201}};
    EXPECT_EQ(planWork(2, 4096 * kMiB, heights, nullptr).heightDepth, 1u);
    EXPECT_TRUE(planWork(2, 4096 * kMiB, heights, nullptr).note.empty());
    EXPECT_EQ(planWork(2, 4096 * kMiB, {.finestLevel = 0, .samples = {5, 5}}, nullptr).heightDepth, 0u);
}

TEST(BlockPlan, RefusesTooLittleMemoryAndSaysHowMuchIsNeeded) {
    try {
        (void)planWork(1, kMinMemoryBytes - 1, {.finestLevel = 0, .samples = {5, 5}}, nullptr);
        FAIL() << "too little memory was accepted";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::usage);
        EXPECT_NE(std::string(error.what()).find("256 MiB"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace terray
