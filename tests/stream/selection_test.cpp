// What is drawn and what is asked for.

#include "client/stream/selection.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "client/stream/selection_geometry.h"
#include "tests/stream/views.h"

namespace terray::test {
namespace {

constexpr double kDown = -1.5707963267948966;

View overview() {
    return viewOf({.position = {2000, 3000, 2500}, .heading = {}, .pitch = radiansFromDegrees(-50)}, 1280, 720);
}

/// Straight down from so near that the finest heights are wanted.
View closeUp() {
    return viewOf({.position = {1300, 4700, 400}, .heading = {}, .pitch = Radians(kDown)}, 1280, 720);
}

bool requests(const Selection& selection, TileLayer layer, const TileId& covered) {
    return std::any_of(selection.wanted.begin(), selection.wanted.end(), [&](const TileRequest& request) {
        return request.layer == layer && request.id.covers(covered);
    });
}

/// Loads all that is wanted, again and again, until nothing is.
Selection settle(TileTree& tree, const FakeDataset& dataset, const View& view, const SelectionOptions& options) {
    for (int frame = 0; frame < 20; ++frame) {
        Selection selection = select(tree, view, options);
        if (selection.complete()) return selection;
        for (const TileRequest& request : selection.wanted) load(tree, dataset, request.layer, request.id);
    }
    ADD_FAILURE() << "selection asks for ever more";
    return {};
}

bool sameNodes(const Selection& a, const Selection& b) {
    return std::equal(a.nodes.begin(), a.nodes.end(), b.nodes.begin(), b.nodes.end(),
                      [](const DrawNode& x, const DrawNode& y) {
                          return x.cell == y.cell && x.heightTile == y.heightTile && x.imageryTile == y.imageryTile;
                      });
}

TEST(Selection, ScreenErrorIsErrorOverDistanceTimesFocalLength) {
    const View view{.tanHalfHeight = 0.5, .width = 100, .height = 200};
    EXPECT_DOUBLE_EQ(screenError(Metres(2), Metres(100), view).value(), 4);
    EXPECT_DOUBLE_EQ(screenError(Metres(2), Metres(0), view).value(), 2 / 1e-3 * 200) << "no division by nothing";
    EXPECT_EQ(screenError(Metres(0), Metres(0), view).value(), 0);
}

TEST(Selection, DrawsTheRootWhileNothingElseIsThereAndAsksForMore) {
    const TileTree tree = rootsOnly(hillyDataset());
    const Selection selection = select(tree, overview(), {});
    ASSERT_EQ(selection.nodes.size(), 1u);
    EXPECT_EQ(selection.nodes[0].cell, TileId{});
    EXPECT_FALSE(selection.nodes[0].heightsExact);
    EXPECT_FALSE(selection.complete());
    for (const TileRequest& request : selection.wanted)
        EXPECT_EQ(request.id.level, 1u) << "only what is known to exist";
}

TEST(Selection, HonoursTheToleranceOrSaysWhatIsMissing) {
    const FakeDataset& dataset = hillyDataset();
    Random random(11);
    for (int round = 0; round < 200; ++round) {
        const TileTree tree = randomTree(dataset, random);
        const SelectionOptions options;
        const Selection selection = select(tree, randomView(dataset, random), options);
        EXPECT_FALSE(selection.limited());
        for (const DrawNode& node : selection.nodes) {
            ASSERT_TRUE(tree.heights(node.heightTile)->resident);
            ASSERT_TRUE(node.heightTile.covers(node.cell));
            const bool finest = node.heightTile.level == tree.finestHeightLevel();
            if (node.heightsExact)
                ASSERT_TRUE(finest || node.screenError <= options.tolerance.value()) << node.cell;
            else
                ASSERT_TRUE(std::any_of(selection.wanted.begin(), selection.wanted.end(),
                                        [&](const TileRequest& request) {
                                            return request.layer == TileLayer::heights &&
                                                   (request.id.covers(node.cell) || node.cell.covers(request.id));
                                        }))
                    << node.cell;
            if (node.imageryTile) {
                ASSERT_TRUE(tree.imagery(*node.imageryTile)->resident);
                ASSERT_TRUE(node.imageryTile->covers(node.cell));
            }
        }
        for (const TileRequest& request : selection.wanted) {
            const bool resident = request.layer == TileLayer::heights ? tree.heights(request.id)->resident
                                                                      : tree.imagery(request.id)->resident;
            ASSERT_FALSE(resident) << request.id;
            ASSERT_TRUE(request.layer == TileLayer::heights ? tree.heights(request.id)->record.exists
                                                            : tree.imagery(request.id)->exists);
        }
        ASSERT_TRUE(std::is_sorted(selection.wanted.begin(), selection.wanted.end(),
                                   [](const auto& a, const auto& b) { return a.priority > b.priority; }));
    }
}

TEST(Selection, ByDistanceAloneEachDoublingIsHalfAsFine) {
    const FakeDataset& dataset = hillyDataset();
    const Tiling& tiling = dataset.metadata.tiling;
    TileTree tree = rootsOnly(dataset);
    SelectionOptions options;
    options.useImagery = false;
    options.tolerance = Pixels(1e6);  // asks for nothing
    for (const double distance : {256.0, 1024.0, 8192.0}) {
        options.lodDistance = distance;
        for (const View& view : {overview(), closeUp()}) {
            size_t finest = 0;
            for (const DrawNode& node : settle(tree, dataset, view, options).nodes) {
                const uint32_t level = node.heightTile.level;
                const auto farther = [&](const TileId& cell, double least) {
                    const auto& record = tree.heights(cell)->record;
                    const Box box = seenBoxOf(cell, {record.minHeight, record.maxHeight}, tiling, view);
                    return distanceTo(box, view.eye).value() >= least;
                };
                finest += level == tiling.finestLevel ? 1 : 0;
                EXPECT_EQ(node.cell, node.heightTile);
                if (level < tiling.finestLevel) {
                    EXPECT_TRUE(farther(node.cell, distance * tiling.spacing(level + 1)));
                }
                if (level > 0) {
                    EXPECT_FALSE(farther(node.cell.parent(), distance * tiling.spacing(level)));
                }
            }
            if (distance > 8000) {
                EXPECT_GT(finest, 0u);
            }
        }
    }
}

TEST(Selection, LoadingWhatIsWantedEndsWithEveryNodeExact) {
    const FakeDataset& dataset = hillyDataset();
    const TileTree full = everything(dataset);
    Random random(12);
    bool coarse = false, fine = false;
    for (int round = 0; round < 100; ++round) {
        const View view = randomView(dataset, random);
        TileTree tree = rootsOnly(dataset);
        for (const DrawNode& node : settle(tree, dataset, view, {}).nodes) {
            EXPECT_TRUE(node.heightsExact && node.imageryExact) << node.cell;
            fine = fine || node.heightTile.level == 2;
            coarse = coarse || node.heightTile.level < 2;
        }
        EXPECT_TRUE(select(full, view, {}).complete());
    }
    EXPECT_TRUE(coarse && fine) << "the views should try several levels";
}

TEST(Selection, IsAPureFunction) {
    const FakeDataset& dataset = hillyDataset();
    Random random(13);
    const TileTree tree = randomTree(dataset, random);
    TileTree other(dataset.metadata.tiling, dataset.metadata.tiling.finestLevel, dataset.metadata.imageryLevel);
    for (auto it = dataset.heights.rbegin(); it != dataset.heights.rend();
         ++it) {  // the same knowledge in another order
        const auto* known = tree.heights(it->first);
        if (known == nullptr || !known->childrenKnown) continue;
        other.learn(it->second);
        other.setHeightsResident(it->first, known->resident);
    }
    for (auto it = dataset.imagery.rbegin(); it != dataset.imagery.rend(); ++it) {
        const auto* known = tree.imagery(it->first);
        if (known == nullptr || !known->childrenKnown) continue;
        other.learn(it->second);
        other.setImageryResident(it->first, known->resident);
    }
    for (int round = 0; round < 20; ++round) {
        const View view = randomView(dataset, random);
        const Selection a = select(tree, view, {}), b = select(other, view, {});
        EXPECT_TRUE(sameNodes(a, b));
        EXPECT_EQ(a.wanted, b.wanted);
    }
}

TEST(Selection, ACellThatShowsNothingFinerIsNotSplitWithoutImageryEither) {
    const FakeDataset& dataset = hillyDataset();
    TileTree tree = rootsOnly(dataset);
    for (uint32_t quadrant = 0; quadrant < 4; ++quadrant) {  // known, but gone again
        load(tree, dataset, TileLayer::heights, TileId{}.child(quadrant));
        tree.setHeightsResident(TileId{}.child(quadrant), false);
    }
    const Selection selection = select(tree, closeUp(), {.useImagery = false});
    ASSERT_EQ(selection.nodes.size(), 1u);
    EXPECT_EQ(selection.nodes[0].cell, TileId{});
    EXPECT_TRUE(requests(selection, TileLayer::heights, {2, 0, 0}));
}

TEST(Selection, DrawsTheSameHeightsAfterTheTreeHasForgotten) {
    const FakeDataset& dataset = hillyDataset();
    Random random(15);
    for (int round = 0; round < 200; ++round) {
        TileTree tree = randomTree(dataset, random);
        const View view = randomView(dataset, random);
        const Selection before = select(tree, view, {.useImagery = false});
        const size_t known = tree.knownTiles();
        tree.forgetBeyond(known);
        EXPECT_EQ(tree.knownTiles(), known) << "not beyond the limit";
        tree.forgetBeyond(0);
        const Selection after = select(tree, view, {.useImagery = false});
        ASSERT_EQ(after.nodes.size(), before.nodes.size());
        EXPECT_TRUE(sameNodes(before, after));
        for (const DrawNode& node : settle(tree, dataset, view, {}).nodes)
            EXPECT_TRUE(node.heightsExact && node.imageryExact) << node.cell;
    }
}

TEST(TileTree, ALongFlightKnowsABoundedNumberOfTiles) {
    constexpr uint32_t kFinest = 12;
    constexpr size_t kMost = 2000;
    TileTree tree({}, kFinest, {});
    HeightTile tile;
    tile.record.exists = true;
    for (HeightRecord& child : tile.children) child.exists = true;
    const auto load = [&](const TileId& id) {
        tile.id = id;
        tree.learn(tile);
        tree.setHeightsResident(id, true);
    };
    load({});
    std::vector<TileId> below;  // resident tiles under the camera
    for (uint32_t x = 0; x < 1u << kFinest; ++x) {
        for (const TileId& id : below) tree.setHeightsResident(id, false);
        below.clear();
        for (uint32_t level = 1; level <= kFinest; ++level)
            below.push_back(TileId{kFinest, x, 100}.ancestor(kFinest - level));
        for (const TileId& id : below) load(id);
        tree.forgetBeyond(kMost);
        ASSERT_LE(tree.knownTiles(), kMost);
        ASSERT_NE(tree.heights({kFinest, x, 100}), nullptr);
    }
    EXPECT_FALSE(tree.heights({1, 0, 0})->childrenKnown) << "left behind";
    EXPECT_TRUE(tree.heights({1, 1, 0})->childrenKnown) << "above the camera";
}

TEST(Selection, FlatGroundWantsFinePhotosOnCoarseHeights) {
    const FakeDataset flat = buildDataset([](int64_t, int64_t) { return 100.0; }, {.imageryLevel = 4});
    const Selection selection = select(everything(flat), closeUp(), {});
    ASSERT_FALSE(selection.nodes.empty());
    for (const DrawNode& node : selection.nodes) {
        EXPECT_EQ(node.heightTile.level, 0u);
        EXPECT_EQ(node.imageryTile->level, node.cell.level);
        EXPECT_GE(node.cell.level, 3u) << "deeper than the finest heights";
    }
}

TEST(Selection, ASceneWithoutImageryPagesNone) {
    const FakeDataset bare = buildDataset(hills(300), {.samples = {1024, 1024}});
    TileTree tree = rootsOnly(bare);
    const Selection selection = settle(tree, bare, closeUp(), {});
    for (const DrawNode& node : selection.nodes) {
        EXPECT_FALSE(node.imageryTile.has_value());
        EXPECT_TRUE(node.imageryExact);
    }

    const Selection unused = select(rootsOnly(hillyDataset()), overview(), {.useImagery = false});
    for (const TileRequest& request : unused.wanted) EXPECT_EQ(request.layer, TileLayer::heights);
    EXPECT_FALSE(unused.nodes[0].imageryTile.has_value());
}

TEST(Selection, NoPhotoIsAskedForWhereThereIsNone) {
    const FakeDataset& dataset = hillyDataset();  // no photo in the western quarter of the levels from 3
    TileTree tree = rootsOnly(dataset);
    const Selection selection = settle(tree, dataset, closeUp(), {});
    int without = 0;
    for (const DrawNode& node : selection.nodes) without += node.imageryTile ? 0 : 1;
    EXPECT_GT(without, 0);
}

TEST(Selection, NeverExceedsItsLongestList) {
    const FakeDataset& dataset = hillyDataset();
    const TileTree tree = everything(dataset);
    Random random(14);
    for (const size_t longest : {1u, 2u, 7u, 30u}) {
        for (int round = 0; round < 30; ++round) {
            const View view = randomView(dataset, random);
            const Selection free = select(tree, view, {});
            const Selection selection = select(tree, view, {.maxNodes = longest});
            EXPECT_LE(selection.nodes.size(), longest);
            EXPECT_EQ(selection.limited(), free.nodes.size() > longest);
            EXPECT_EQ(selection.nodes.empty(), free.nodes.empty()) << "coarse cells remain";
        }
    }
}

TEST(Selection, NeverNeedsMoreTilesThanItMayAndGivesUpDetailEvenly) {
    const FakeDataset& dataset = hillyDataset();
    Random random(15);
    for (int round = 0; round < 40; ++round) {
        const View view = randomView(dataset, random);
        const Selection free = select(everything(dataset), view, {});
        for (const size_t most : {0u, 1u, 3u, 9u}) {
            const SelectionOptions options{.maxHeightTiles = most, .maxImageryTiles = 2 * most};
            TileTree tree = rootsOnly(dataset);
            const Selection selection = settle(tree, dataset, view, options);
            EXPECT_LE(selection.heightTiles.size(), most);
            EXPECT_LE(selection.imageryTiles.size(), 2 * most);
            EXPECT_TRUE(selection.coarsening.heights > 1 || free.heightTiles.size() <= most);
            EXPECT_TRUE(selection.coarsening.imagery > 1 || free.imageryTiles.size() <= 2 * most);
            EXPECT_TRUE(selection.limited() || selection.nodes.size() == free.nodes.size());
            for (const DrawNode& node : selection.nodes) {
                EXPECT_TRUE(node.heightsExact && node.imageryExact);
                const bool finest = node.heightTile.level == tree.finestHeightLevel();
                EXPECT_TRUE(finest || node.screenError <= options.tolerance.value() * selection.coarsening.heights);
            }
            // What is needed hangs on no residency: nothing is wanted in turns.
            for (const auto& [id, tile] : dataset.heights)
                if (id.level > 0 && tree.heights(id) && tree.heights(id)->resident) tree.setHeightsResident(id, false);
            for (const auto& [id, tile] : dataset.imagery)
                if (id.level > 0 && tree.imagery(id) && tree.imagery(id)->resident) tree.setImageryResident(id, false);
            const Selection again = select(tree, view, options);
            EXPECT_EQ(again.heightTiles, selection.heightTiles);
            EXPECT_EQ(again.imageryTiles, selection.imageryTiles);
        }
    }
}

TEST(Selection, AMissingTileIsStoodInForByItsNearestResidentAncestor) {
    const FakeDataset& dataset = hillyDataset();
    TileTree tree = everything(dataset);
    const View view = closeUp();
    const Selection ideal = select(tree, view, {});
    const auto finest = std::find_if(ideal.nodes.begin(), ideal.nodes.end(),
                                     [](const auto& node) { return node.heightTile.level == 2; });
    ASSERT_NE(finest, ideal.nodes.end());
    const TileId missing = finest->heightTile;
    tree.setHeightsResident(missing, false);

    const Selection selection = select(tree, view, {});
    ASSERT_EQ(selection.wanted.size(), 1u);
    EXPECT_EQ(selection.wanted[0].id, missing);
    const double expected =
        screenError(Metres(dataset.heights.at(missing.parent()).record.error), Metres(1), view).value();
    EXPECT_LT(selection.wanted[0].priority, expected) << "the stand-in's error, from farther than a metre";
    EXPECT_GT(selection.wanted[0].priority, 0);
    for (const DrawNode& node : selection.nodes) {
        EXPECT_EQ(node.heightsExact, !missing.covers(node.cell));
        EXPECT_EQ(node.heightTile,
                  missing.covers(node.cell) ? missing.parent() : node.cell.ancestor(node.cell.level - 2));
    }
}

TEST(Selection, AMissingTileIsStoodInForByItsChildrenWhereAllAreResident) {
    const FakeDataset& dataset = hillyDataset();
    TileTree tree = everything(dataset);
    // The middle level is fine enough, and the root is not.
    const View view = viewOf({.position = {2000, 0, 3000}, .pitch = radiansFromDegrees(-30)}, 400, 250);
    const double rootError = select(rootsOnly(dataset), view, {}).nodes.at(0).screenError;
    const SelectionOptions options{.tolerance = Pixels(0.95 * rootError), .useImagery = false};
    const Selection ideal = select(tree, view, options);
    const auto middle = std::find_if(ideal.nodes.begin(), ideal.nodes.end(),
                                     [](const auto& node) { return node.heightTile.level == 1; });
    ASSERT_NE(middle, ideal.nodes.end());
    const TileId missing = middle->heightTile;
    tree.setHeightsResident(missing, false);
    const auto drawnThere = [&] {
        std::set<TileId> drawn;
        const Selection selection = select(tree, view, options);
        EXPECT_EQ(selection.heightTiles, ideal.heightTiles) << "what is needed stays the same";
        EXPECT_EQ(selection.wanted.size(), 1u);
        for (const DrawNode& node : selection.nodes) {
            EXPECT_EQ(node.heightsExact, !missing.covers(node.cell));
            if (missing.covers(node.cell)) drawn.insert(node.heightTile);
        }
        return drawn;
    };
    for (const TileId& tile : drawnThere()) EXPECT_EQ(tile.parent(), missing);
    tree.setHeightsResident(missing.child(2), false);
    EXPECT_EQ(drawnThere(), std::set<TileId>{TileId{}}) << "one of the children lacks";
}

TEST(Selection, AMissingMiddleLevelIsNeitherNeededNorAskedFor) {
    const FakeDataset& dataset = hillyDataset();
    TileTree tree = everything(dataset);
    for (const auto& [id, tile] : dataset.heights)
        if (id.level == 1) tree.setHeightsResident(id, false);
    const Selection selection = select(tree, closeUp(), {.tolerance = Pixels(1e-6)});
    EXPECT_TRUE(selection.complete());
    for (const DrawNode& node : selection.nodes) EXPECT_EQ(node.heightTile.level, 2u);
    // Where the middle level is fine enough, and the root is not, it is asked for.
    const View far = viewOf({.position = {2000, 0, 3000}, .pitch = radiansFromDegrees(-30)}, 400, 250);
    const double rootError = select(rootsOnly(dataset), far, {}).nodes.at(0).screenError;
    const Selection middle = select(tree, far, {.tolerance = Pixels(0.95 * rootError), .useImagery = false});
    EXPECT_FALSE(middle.complete());
    for (const TileRequest& request : middle.wanted) EXPECT_EQ(request.id.level, 1u);
}

TEST(Selection, AStandInIsNoMoreThanNineLevelsAboveItsCell) {
    // One path of twelve tiles, each the north-western child of the one before, all known, only the root resident.
    constexpr uint32_t kFinest = 12;
    const auto record = [](uint32_t level) {
        return HeightRecord{
            .exists = true, .hasHoles = false, .minHeight = 0, .maxHeight = 10, .error = level < kFinest ? 1e6f : 0};
    };
    TileTree tree({0, 0, 1, kFinest}, kFinest, {});
    for (uint32_t level = 0; level <= kFinest; ++level) {
        HeightTile tile{.id = {level, 0, 0}, .encoding = {}, .record = record(level), .children = {}, .codes = {}};
        if (level < kFinest) tile.children[0] = record(level + 1);
        tree.learn(tile);
    }
    tree.setHeightsResident({}, true);
    const View view = viewOf({.position = {100, -100, 500}, .pitch = Radians(kDown)}, 300, 300);
    const Selection selection = select(tree, view, {});
    ASSERT_EQ(selection.wanted.size(), 1u);
    EXPECT_EQ(selection.wanted[0].id, (TileId{9, 0, 0})) << "then the finest is within nine levels";
    tree.setHeightsResident({9, 0, 0}, true);
    EXPECT_EQ(select(tree, view, {}).wanted.at(0).id, (TileId{kFinest, 0, 0}));
}

TEST(Selection, GroundWithoutSurfaceIsNotDrawn) {
    // The eastern half is a hole, so its tiles do not exist.
    const FakeDataset half =
        buildDataset([](int64_t x, int64_t y) { return x < 1024 ? static_cast<double>(x % 97 + y % 41) : NAN; }, {});
    TileTree tree = rootsOnly(half);
    const View view = viewOf(
        {.position = {2024, 3976, 1500}, .pitch = Radians(kDown), .verticalFov = radiansFromDegrees(90)}, 900, 900);
    const Selection selection = settle(tree, half, view, {});
    EXPECT_GT(selection.nodes.size(), 1u);
    for (const DrawNode& node : selection.nodes)
        EXPECT_LT(tree.tiling().bounds(node.cell).west, 1000 + 1024) << node.cell;
}

TEST(Selection, LooksStraightUpAndDown) {
    const TileTree tree = everything(hillyDataset());
    Camera camera{.position = {2000, 4000, 1000}, .pitch = Radians(-kDown)};
    EXPECT_TRUE(select(tree, viewOf(camera, 500, 500), {}).nodes.empty()) << "nothing but sky";
    camera.pitch = Radians(kDown);
    EXPECT_FALSE(select(tree, viewOf(camera, 500, 500), {}).nodes.empty());
}

TEST(Selection, AsksForTheRootPhotoWhenItIsMissing) {
    const FakeDataset& dataset = hillyDataset();
    TileTree tree(dataset.metadata.tiling, 2, 4);
    load(tree, dataset, TileLayer::heights, {});
    const Selection selection = select(tree, overview(), {});
    EXPECT_TRUE(requests(selection, TileLayer::imagery, {}));
    EXPECT_FALSE(selection.nodes[0].imageryTile.has_value());
    EXPECT_FALSE(selection.nodes[0].imageryExact);
}

}  // namespace
}  // namespace terray::test
