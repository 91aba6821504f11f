// Pictures of edited ground: watertight at tile borders and level jumps, the same by both launches, the same whenever
// the edits came, and gone when they are undone.

#include <cmath>
#include <memory>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "common/checksum.h"
#include "tests/common/temporary_directory.h"
#include "tests/e2e/comparison.h"
#include "tests/e2e/patch_oracle.h"
#include "tests/support/edited_tile.h"

namespace terray {
namespace {

constexpr int kWidth = 72;
constexpr int kHeight = 48;

TerrainEdit crater(glm::dvec2 centre, double radius, double depth, double rim) {
    return {
        .kind = TerrainEdit::Kind::crater, .line = {{centre, centre}}, .radius = radius, .height = depth, .rim = rim};
}

class EditsTest : public testing::Test {
  protected:
    HeadlessContext context_{HeadlessContext::Options{.debug = true}};
    ShaderLibrary shaders_;
    void TearDown() override { EXPECT_EQ(context_.takeDebugMessages(), ""); }

    std::unique_ptr<Engine> engine(const TileSource& source, const EngineOptions& options) {
        return std::make_unique<Engine>(source, shaders_, options, kWidth, kHeight);
    }

    /// Craters and strokes of all sizes over the whole dataset, and a crater across the corner of four tiles.
    static EditList someEdits(const ComputedDataset& dataset, int count) {
        std::mt19937 random(77);
        const auto uniform = [&](double a, double b) {
            return a + (b - a) * (static_cast<double>(random()) * 0x1p-32);
        };
        const Tiling& tiling = dataset.source().metadata().tiling;
        EditList edits = randomEdits(uniform, dataset.ground(), tiling.finestSpacing, count);
        const GroundRect tile = tiling.bounds({tiling.finestLevel, 0, 0});
        edits.push_back(crater({tile.east, tile.south}, 40 * tiling.finestSpacing, 250, 60));
        return edits;
    }
};

/// Whether two engines drew the same, to the last bit.
bool samePicture(const Engine& a, const Engine& b) {
    return a.targets().readSrgb() == b.targets().readSrgb() && a.targets().readNodes() == b.targets().readNodes() &&
           a.targets().readNormals() == b.targets().readNormals();
}

/// The contents of a dataset's heights on disk.
uint32_t checksumOf(const ComputedDataset& dataset) {
    std::ifstream file(dataset.directory() / kHeightsFile, std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    return crc32c(std::as_bytes(std::span(text)));
}

TEST_F(EditsTest, EditedGroundShowsNoHoleByEitherLaunch) {
    const ComputedDataset dataset(2048, 10, 31);
    // Among them a hill and a pit beyond all heights that the dataset has.
    EditList edits = someEdits(dataset, 12);
    const GroundRect ground = dataset.ground();
    const glm::dvec2 corner(ground.west, ground.south), across(ground.east - ground.west, ground.north - ground.south);
    for (const double share : {0.3, 0.6}) {
        const glm::dvec2 place = corner + share * across;
        edits.push_back({.kind = TerrainEdit::Kind::level,
                         .line = {{place, place + glm::dvec2(2500, 0)}},
                         .radius = 1500,
                         .full = 400,
                         .height = share < 0.5 ? 2900.0 : -900.0});
    }
    const EditedSource truth(dataset.source(), edits);
    ColumnOracle columns(truth);
    PatchOracle patches(columns, Surface::automatic);
    std::mt19937 random(5);
    Comparison all;
    struct Case {
        Surface surface;
        Launch launch;
        uint64_t slots;
    };
    for (const Case& one :
         {Case{Surface::columns, Launch::raster, 4}, Case{Surface::columns, Launch::compute, 60},
          Case{Surface::automatic, Launch::raster, 60}, Case{Surface::automatic, Launch::compute, 4}}) {
        EngineOptions options = inspectedOptions(one.surface);
        options.gpuHeightBytes = one.slots * 720'000;
        options.render.launch = one.launch;
        options.edits = edits;
        const auto drawing = engine(dataset.source(), options);
        const auto meet = [&](const auto&... arguments) {
            return one.surface == Surface::columns ? columns.meet(arguments...) : patches.meet(arguments...);
        };
        for (int i = 0; i < 5; ++i) {
            drawing->drawFrame(randomCamera(random, columns), true);
            const auto pixels = truthOf(drawing->nodes(), drawing->view(), truth.metadata(), meet);
            const Comparison result = compare(pixels, drawing->nodes(), drawing->targets());
            EXPECT_TRUE(result.clean()) << result << "; slots " << one.slots << ", camera " << i;
            all += result;
        }
    }
    EXPECT_GT(all.ground, all.pixels / 4);
    EXPECT_GT(all.jumps, 20) << "a starved budget takes detail evenly, so few levels meet";
}

TEST_F(EditsTest, EditsAtRunTimeMakeThePicturesOfAnEngineThatBeganWithThem) {
    const ComputedDataset dataset(2048, 10, 32);
    const EditList edits = someEdits(dataset, 6);
    const glm::dvec3 middle(1000 + 10'240, 5000 - 10'240, dataset.source().metadata().maxHeight);
    const std::vector<Camera> cameras = {cameraAt(middle + glm::dvec3(0, 0, 800), 40, -35, 60),
                                         cameraAt(middle + glm::dvec3(-7000, 5000, 3000), 130, -60, 70)};
    const auto live = engine(dataset.source(), inspectedOptions());
    EngineOptions withEdits = inspectedOptions();
    for (size_t n = 0; n < edits.size(); ++n) {
        live->addEdit(edits[n]);
        withEdits.edits.push_back(edits[n]);
        if (n % 3 != 0) continue;  // some come two to a frame
        const auto fresh = engine(dataset.source(), withEdits);
        for (const Camera& camera : cameras) {
            live->drawFrame(camera, true);
            fresh->drawFrame(camera, true);
            EXPECT_TRUE(samePicture(*live, *fresh)) << n;
        }
    }
}

TEST_F(EditsTest, UndoneEditsLeaveThePictureAndTheDatasetAsTheyWere) {
    const ComputedDataset dataset(1024, 10, 33);
    const uint32_t before = checksumOf(dataset);
    const Camera camera = cameraAt({6000, -500, dataset.source().metadata().maxHeight + 2500}, 20, -50, 60);
    const auto plain = engine(dataset.source(), inspectedOptions()),
               live = engine(dataset.source(), inspectedOptions());
    plain->drawFrame(camera, true);
    live->setEdits(someEdits(dataset, 9));
    EXPECT_GT(live->drawFrame(camera, true).editedTiles, 1u);
    EXPECT_FALSE(samePicture(*plain, *live));
    live->setEdits({});
    EXPECT_EQ(live->drawFrame(camera, true).editedTiles, 0u);
    EXPECT_TRUE(samePicture(*plain, *live));
    EXPECT_EQ(checksumOf(dataset), before);
}

TEST_F(EditsTest, AChangeMakesAnewOnlyTheTilesItTouchesAndAtOnce) {
    const ComputedDataset dataset(2048, 10, 34);
    const Tiling& tiling = dataset.source().metadata().tiling;
    // Beside the border to another tile, and so near that all ground in the picture is at its finest, whatever the
    // crater's error.
    const glm::dvec2 inside = sampleCentre(tiling, {2, 1, 2}, 480, 250);
    const auto live = engine(dataset.source(), inspectedOptions());
    const double height = dataset.source().metadata().maxHeight;
    const Camera camera = cameraAt({inside + glm::dvec2(320, 0), height + 150}, 0, -90, 60);
    const FrameReport first = live->drawFrame(camera, true);
    EXPECT_EQ(first.editedTiles, 0u);
    std::set<TileId> drawn;
    for (const DrawNode& node : live->nodes()) drawn.insert(node.heightTile);
    EXPECT_TRUE(drawn.contains({2, 1, 2}) && drawn.contains({2, 2, 2}));
    const std::vector<TileId> before = live->tiles().heightTiles();
    // The root and the tile itself, the only ones over the crater that are drawn. Nothing is read again, nothing stands
    // in.
    live->addEdit(crater(inside, 50, 20, 5));
    const FrameReport edited = live->drawFrame(camera, false);
    EXPECT_EQ(edited.editedTiles, 2u);
    EXPECT_EQ(edited.uploadedTiles, 2u);
    for (const TileId& id : before) EXPECT_TRUE(id == (TileId{1, 0, 1}) || live->tiles().heights(id) != nullptr) << id;
    EXPECT_EQ(edited.wanted, 0u);
    EXPECT_EQ(edited.pager.bytesRead, first.pager.bytesRead);
    EXPECT_GT(edited.gpuMs[static_cast<size_t>(GpuPass::edit)], 0);
    const FrameReport next = live->drawFrame(camera, false);
    EXPECT_EQ(next.uploadedTiles, 0u);
    EXPECT_EQ(next.gpuMs[static_cast<size_t>(GpuPass::edit)], 0);
    // A second one elsewhere in the same tiles: again these and no others.
    live->addEdit(crater(inside + glm::dvec2(0, 200), 40, 15, 4));
    EXPECT_EQ(live->drawFrame(camera, false).uploadedTiles, 2u);
}

TEST_F(EditsTest, BothLaunchesDrawTheSameEditedGroundWithShadowsOverASmallEarthExaggerated) {
    const ComputedDataset dataset(1024, 10, 35);
    EngineOptions options = inspectedOptions();
    options.edits = someEdits(dataset, 9);
    options.render.shadows = ShadowOptions{};
    options.earth = kSmallEarth;
    options.exaggeration = 1.7;
    options.render.launch = Launch::raster;
    const auto raster = engine(dataset.source(), options);
    options.render.launch = Launch::compute;
    const auto compute = engine(dataset.source(), options);
    for (const double pitch : {-80.0, -25.0, -5.0}) {
        const Camera camera = cameraAt({6000, 0, dataset.source().metadata().maxHeight + 700}, 20, pitch, 60);
        raster->drawFrame(camera, true);
        compute->drawFrame(camera, true);
        EXPECT_TRUE(samePicture(*raster, *compute));
        EXPECT_EQ(raysOutOfSteps(raster->targets()), 0);
    }
}

TEST_F(EditsTest, HolesStayHoles) {
    const auto heights = [](int64_t column, int64_t row) {
        return (column / 40 + row / 40) % 3 == 0 ? kNoHeight : static_cast<float>(200 + (column + row) % 7);
    };
    const ComputedDataset dataset(heights, {1024, 1024}, 4);
    EngineOptions options = inspectedOptions(Surface::columns);
    const Camera camera = cameraAt({3048, 2952, 3500}, 0, -90, 60);
    const auto plain = engine(dataset.source(), options);
    // Level, and back to where it was within half a metre: seen from above the same ground, with the same holes.
    const glm::dvec2 centre(3048, 2952);
    options.edits = {
        {.kind = TerrainEdit::Kind::level, .line = {{centre, centre}}, .radius = 900, .full = 800, .height = 203}};
    const auto levelled = engine(dataset.source(), options);
    plain->drawFrame(camera, true);
    levelled->drawFrame(camera, true);
    const auto before = plain->targets().readSrgb(), after = levelled->targets().readSrgb();
    int64_t holes = 0, differing = 0;
    for (size_t n = 0; n < before.cells().size(); ++n) {
        const bool hole = before.cells()[n] == kSignal;
        holes += hole ? 1 : 0;
        differing += hole != (after.cells()[n] == kSignal) ? 1 : 0;
    }
    EXPECT_GT(holes, 500);
    EXPECT_LT(differing, holes / 20) << "walls of 3 m, seen at a slant";
}

}  // namespace
}  // namespace terray
