// Records of edited ground bound what is drawn: boxes, errors, encodings, level by level.

#include "common/edited_ground.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "client/stream/selection.h"
#include "tests/stream/views.h"
#include "tests/support/edited_tile.h"

namespace terray::test {
namespace {

EditList someEdits(Random& random, const DatasetMetadata& metadata, int count) {
    return randomEdits([&](double a, double b) { return random.uniform(a, b); }, metadata.groundBounds(),
                       metadata.tiling.finestSpacing, count);
}

/// The extremes of edited finest samples under each sample of a level, as whole grids from level to level.
struct Extremes {
    Grid<float> low, high;
};

Extremes finestExtremes(const FakeDataset& dataset, const EditedGround& ground) {
    const Tiling& tiling = dataset.metadata.tiling;
    const int64_t side = int64_t{kTileCore} << tiling.finestLevel;
    Grid<float> heights({side, side});
    for (const auto& [id, tile] : dataset.heights) {
        if (id.level != tiling.finestLevel) continue;
        const EditList near = ground.near(id);
        for (int64_t y = 0; y < kTileCore; ++y)
            for (int64_t x = 0; x < kTileCore; ++x) {
                const double height = tile.encoding.height(tile.codes.at(x + kHeightApron, y + kHeightApron));
                heights.at(int64_t{id.x} * kTileCore + x, int64_t{id.y} * kTileCore + y) =
                    static_cast<float>(editedHeight(height, sampleCentre(tiling, id, x, y), near));
            }
    }
    return {heights, heights};
}

Extremes coarser(const Extremes& fine) {
    const int64_t side = fine.low.width() / 2;
    Extremes coarse{Grid<float>({side, side}), Grid<float>({side, side})};
    for (int64_t y = 0; y < side; ++y)
        for (int64_t x = 0; x < side; ++x) {
            const auto four = [&](const Grid<float>& grid, auto pick) {
                return pick(pick(grid.at(2 * x, 2 * y), grid.at(2 * x + 1, 2 * y)),
                            pick(grid.at(2 * x, 2 * y + 1), grid.at(2 * x + 1, 2 * y + 1)));
            };
            coarse.low.at(x, y) = four(fine.low, [](float a, float b) { return std::min(a, b); });
            coarse.high.at(x, y) = four(fine.high, [](float a, float b) { return std::max(a, b); });
        }
    return coarse;
}

TEST(EditedGround, RecordsBoundEverySampleAndEveryFinestSampleBeneath) {
    const FakeDataset& dataset = hillyDataset();
    const Tiling& tiling = dataset.metadata.tiling;
    Random random(7);
    double tightest = 0;
    for (const int count : {5, 30}) {
        const EditedGround ground(tiling, dataset.metadata.quantum, someEdits(random, dataset.metadata, count));
        Extremes extremes = finestExtremes(dataset, ground);
        for (uint32_t level = tiling.finestLevel;; --level) {
            for (const auto& [id, stored] : dataset.heights) {
                if (id.level != level) continue;
                const HeightRecord record = ground.record(id, stored.record).value_or(stored.record);
                const HeightTile tile = editedTile(stored, ground);  // checks that nothing is clipped
                ASSERT_LE(record.minHeight, tile.record.minHeight) << id;
                ASSERT_GE(record.maxHeight, tile.record.maxHeight) << id;
                double error = 0;
                for (int64_t y = 0; y < kTileCore; ++y)
                    for (int64_t x = 0; x < kTileCore; ++x) {
                        const double height = tile.encoding.height(tile.codes.at(x + kHeightApron, y + kHeightApron));
                        const int64_t column = int64_t{id.x} * kTileCore + x, row = int64_t{id.y} * kTileCore + y;
                        error = std::max(
                            {error, extremes.high.at(column, row) - height, height - extremes.low.at(column, row)});
                    }
                // Errors count from the source's samples, extremes from those to half a quantum, as floats.
                const double slack = dataset.metadata.quantum / 2 + 1e-4;
                ASSERT_LE(error, record.error + slack) << id << " of " << count;
                if (level < tiling.finestLevel && record.error > 2 * stored.record.error)
                    tightest = std::max(tightest, error / record.error);
            }
            if (level == 0) break;
            extremes = coarser(extremes);
        }
    }
    EXPECT_GT(tightest, 0.5) << "bounds that nothing comes near to are none";
}

TEST(EditedGround, LeavesTilesAloneThatNoEditIsNearAndHolesAsTheyAre) {
    const FakeDataset& dataset = hillyDataset();
    const Tiling& tiling = dataset.metadata.tiling;
    const glm::dvec2 centre = sampleCentre(tiling, {2, 1, 1}, 100, 100);
    const EditedGround ground(
        tiling, dataset.metadata.quantum,
        {{.kind = TerrainEdit::Kind::crater, .line = {{centre, centre}}, .radius = 30, .height = 9}});
    for (const auto& [id, tile] : dataset.heights) {
        const bool over = id.covers({2, 1, 1}) || TileId{2, 1, 1}.covers(id);
        EXPECT_EQ(ground.record(id, tile.record).has_value(), over) << id;
        EXPECT_EQ(ground.describe(tile).has_value(), over) << id;
        EXPECT_EQ(ground.near(id).empty(), !over) << id;
    }
    EXPECT_FALSE(ground.record({2, 1, 1}, HeightRecord{})) << "there is no surface";
    HeightTile tile = dataset.heights.at({2, 1, 1});
    tile.codes.at(102, 102) = kNoSurface;
    EXPECT_EQ(editedTile(tile, ground).codes.at(102, 102), kNoSurface);
}

TEST(EditedGround, KeepsUntouchedHeightsToTheLastBitUnlessStepsGrow) {
    const FakeDataset& dataset = hillyDataset();
    const Tiling& tiling = dataset.metadata.tiling;
    const HeightTile& tile = dataset.heights.at({2, 1, 1});
    const glm::dvec2 centre = sampleCentre(tiling, tile.id, 100, 100);
    for (const auto& [depth, finer] : {std::pair(9.0, true), std::pair(9000.0, false)}) {
        const EditedGround ground(
            tiling, dataset.metadata.quantum,
            {{.kind = TerrainEdit::Kind::crater, .line = {{centre, centre}}, .radius = 30, .height = depth}});
        const HeightTile edited = editedTile(tile, ground);
        EXPECT_EQ(edited.encoding.exponent == tile.encoding.exponent, finer);
        const double half = edited.encoding.metresPerCode() / 2;
        for (int64_t x = 200; x < 400; ++x) {
            const double height = edited.encoding.height(edited.codes.at(x, 300));
            EXPECT_NEAR(height, tile.encoding.height(tile.codes.at(x, 300)), finer ? 0 : half + 1e-9);
        }
        EXPECT_NEAR(edited.encoding.height(edited.codes.at(102, 102)),
                    tile.encoding.height(tile.codes.at(102, 102)) - depth, half + 1e-9);
    }
}

TEST(EditedGround, TilesAreConcernedThroughTheirApronToo) {
    const FakeDataset& dataset = hillyDataset();
    const Tiling& tiling = dataset.metadata.tiling;
    const glm::dvec2 centre = sampleCentre(tiling, {2, 1, 1}, 511, 300);  // one sample west of tile 2/2/1
    const EditedGround ground(
        tiling, dataset.metadata.quantum,
        {{.kind = TerrainEdit::Kind::raise, .line = {{centre, centre}}, .radius = 0.8, .full = 0.4, .height = 50}});
    const HeightTile &west = dataset.heights.at({2, 1, 1}), &east = dataset.heights.at({2, 2, 1});
    const HeightTile editedWest = editedTile(west, ground), editedEast = editedTile(east, ground);
    const auto height = [](const HeightTile& tile, int64_t column) {
        return tile.encoding.height(tile.codes.at(column + kHeightApron, 300 + kHeightApron));
    };
    EXPECT_NEAR(height(editedWest, 511) - height(west, 511), 50, 0.01);
    EXPECT_NEAR(height(editedEast, -1) - height(east, -1), 50, 0.01);
    EXPECT_EQ(height(editedEast, 0), height(east, 0));
}

TEST(EditedGround, ManyEditsFarFromOneAnotherDoNotAddUp) {
    const FakeDataset& dataset = hillyDataset();
    EditList craters;
    for (int x = 0; x < 20; ++x)
        for (int y = 0; y < 20; ++y) {
            const glm::dvec2 centre(1050 + 100 * x, 4950 - 100 * y);
            craters.push_back(
                {.kind = TerrainEdit::Kind::crater, .line = {{centre, centre}}, .radius = 15, .height = 40, .rim = 10});
        }
    const EditedGround ground(dataset.metadata.tiling, dataset.metadata.quantum, craters);
    for (const auto& [id, tile] : dataset.heights) {
        const HeightRecord edited = ground.record(id, tile.record).value();
        // At the root, whose samples are 4 m apart, squares with their margins hold up to four.
        const int together = id.level == 0 ? 4 : 1;
        EXPECT_LT(edited.maxHeight, tile.record.maxHeight + 10.1 * together) << id;
        EXPECT_GT(edited.minHeight, tile.record.minHeight - 40.1 * together) << id;
        EXPECT_LT(edited.error, tile.record.error + 50.1 * together) << id;
    }
}

TEST(EditedGround, ATreeUnderEditsKnowsTheSameWheneverItLearntOfThem) {
    const FakeDataset& dataset = hillyDataset();
    Random random(8);
    const auto ground = std::make_shared<const EditedGround>(dataset.metadata.tiling, dataset.metadata.quantum,
                                                             someEdits(random, dataset.metadata, 6));
    const auto other = std::make_shared<const EditedGround>(dataset.metadata.tiling, dataset.metadata.quantum,
                                                            someEdits(random, dataset.metadata, 9));
    const TileTree plain = everything(dataset);
    TileTree later = plain;
    later.setEdits(other);
    later.setEdits(ground);
    TileTree from(dataset.metadata.tiling, dataset.metadata.tiling.finestLevel, {});
    from.setEdits(ground);
    for (const auto& [id, tile] : dataset.heights) load(from, dataset, TileLayer::heights, id);
    TileTree undone = later;
    undone.setEdits(nullptr);
    int edited = 0;
    for (const auto& [id, tile] : dataset.heights) {
        const HeightRecord expected = ground->record(id, tile.record).value_or(tile.record);
        edited += expected != tile.record ? 1 : 0;
        for (const TileTree* tree : {&later, &from}) {
            EXPECT_EQ(tree->heights(id)->record, expected) << id;
            EXPECT_EQ(tree->heights(id)->metresPerCode, from.heights(id)->metresPerCode) << id;
        }
        if (const auto described = ground->describe(tile)) {
            EXPECT_GE(later.coarsestEditedStep(), described->encoding.metresPerCode()) << id;
        }
        EXPECT_EQ(undone.heights(id)->record, tile.record) << id;
        EXPECT_EQ(undone.heights(id)->metresPerCode, tile.encoding.metresPerCode()) << id;
    }
    EXPECT_GT(edited, 5);
    EXPECT_EQ(later.coarsestEditedStep(), from.coarsestEditedStep());
    EXPECT_EQ(undone.coarsestEditedStep(), 0);
}

TEST(EditedGround, NodesAreRefinedForASmallCraterNearTheEyeAndHoldItInTheirBoxes) {
    const FakeDataset flat = buildDataset([](int64_t, int64_t) { return 100.0; }, {});
    const glm::dvec2 centre(1800, 4200);
    TileTree tree = everything(flat);
    const View view = viewOf({.position = {centre, 400}, .heading = {}, .pitch = Radians(-1.5707963)}, 1280, 720);
    EXPECT_EQ(select(tree, view, {}).nodes.size(), 1u) << "flat ground needs one node";
    tree.setEdits(std::make_shared<const EditedGround>(
        flat.metadata.tiling, flat.metadata.quantum,
        EditList{{.kind = TerrainEdit::Kind::crater, .line = {{centre, centre}}, .radius = 6, .height = 5, .rim = 1}}));
    int over = 0;
    for (const DrawNode& node : select(tree, view, {}).nodes) {
        const GroundRect square = flat.metadata.tiling.bounds(node.cell);
        if (centre.x < square.west || centre.x > square.east || centre.y < square.south || centre.y > square.north)
            continue;
        ++over;
        EXPECT_EQ(node.heightTile.level, flat.metadata.tiling.finestLevel);
        EXPECT_LE(node.minHeight, 95);
        EXPECT_GE(node.maxHeight, 101);
    }
    EXPECT_EQ(over, 1);
}

}  // namespace
}  // namespace terray::test
