// Edits on the GPU: codes as the CPU computes them, pyramids over them, aprons that agree, holes that stay.

#include "client/render/tile_editor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "client/render/gpu_tiles.h"
#include "common/error.h"
#include "tests/common/temporary_directory.h"
#include "tests/render/gl_test.h"
#include "tests/support/edited_tile.h"

namespace terray {
namespace {

constexpr Tiling kTiling{.west = 431'250, .north = 5'123'450, .finestSpacing = 2, .finestLevel = 3};
constexpr double kQuantum = 0.01;

/// Hills of 300 m with noise and a few holes, by the global sample: the same in a core and in a neighbour's apron.
HeightTile hillsTile(const TileId& id) {
    HeightTile tile;
    tile.id = id;
    tile.encoding = HeightEncoding::covering(-10, 340, kQuantum);
    tile.codes = Grid<uint16_t>({kHeightTileSide, kHeightTileSide}, kNoSurface);
    const GridRect core = Tiling::coreSamples(id);
    for (int64_t y = 0; y < kHeightTileSide; ++y)
        for (int64_t x = 0; x < kHeightTileSide; ++x) {
            const int64_t column = core.x + x - kHeightApron, row = core.y + y - kHeightApron;
            const auto noise = static_cast<uint64_t>(column * 7919 + row * 104729) % 997;
            const double height =
                160 + 150 * std::sin(0.01 * static_cast<double>(column)) * std::cos(0.013 * static_cast<double>(row)) +
                0.01 * static_cast<double>(noise);
            if (noise != 13) tile.codes.at(x, y) = tile.encoding.code(height);
        }
    tile.record = measureRecord(tile.codes, tile.encoding, 3);
    return tile;
}

Grid<uint16_t> readLevel(const GpuTiles& tiles, const TileId& id, int level) {
    const int side = kHeightTileSide >> level;
    Grid<uint16_t> texels({side, side});
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTextureSubImage(tiles.heightTexture(), level, 0, 0, static_cast<GLint>(tiles.heights(id)->slot), side, side, 1,
                         GL_RED_INTEGER, GL_UNSIGNED_SHORT, static_cast<GLsizei>(texels.cells().size_bytes()),
                         texels.cells().data());
    return texels;
}

class TileEditorTest : public GlTest {
  protected:
    ShaderLibrary shaders_;
    GpuTiles tiles_{shaders_, {.heightTiles = 4}};

    static EditList someEdits(uint32_t seed, const GroundRect& around, int count) {
        std::mt19937 random(seed);
        const auto uniform = [&](double a, double b) {
            return a + (b - a) * (static_cast<double>(random()) * 0x1p-32);
        };
        return randomEdits(uniform, around, 4, count);
    }

    /// Uploads a tile with edits, and compares every code with the closed form, stated bound and all.
    /// @return samples that the edits moved
    int64_t expectEdited(const HeightTile& stored, const EditedGround& ground) {
        const auto edited = ground.describe(stored);
        EXPECT_TRUE(edited.has_value());
        EXPECT_TRUE(tiles_.uploadHeights(stored, &*edited).done);
        const HeightEncoding& encoding = tiles_.heights(stored.id)->encoding;
        EXPECT_EQ(encoding, edited->encoding);
        EXPECT_EQ(tiles_.heights(stored.id)->record, edited->record);
        const Grid<uint16_t> codes = readLevel(tiles_, stored.id, 0);
        int64_t wrong = 0, moved = 0;
        for (int64_t y = 0; y < kHeightTileSide; ++y)
            for (int64_t x = 0; x < kHeightTileSide; ++x) {
                const uint16_t code = stored.codes.at(x, y);
                if (code == kNoSurface) {
                    wrong += codes.at(x, y) != kNoSurface;
                    continue;
                }
                const glm::dvec2 place = sampleCentre(kTiling, stored.id, x - kHeightApron, y - kHeightApron);
                const double before = stored.encoding.height(code);
                const double height = editedHeight(before, place, ground.edits());
                const double bound = encoding.metresPerCode() / 2 + 0x1p-40 * (std::abs(height) + 1e4);
                wrong += codes.at(x, y) == kNoSurface || std::abs(encoding.height(codes.at(x, y)) - height) > bound;
                moved += height != before;
            }
        EXPECT_EQ(wrong, 0);
        expectPyramid(stored.id, codes);
        return moved;
    }

    /// Level 1 and the coarsest are the maxima of the codes beneath and around; boxes for bilinear surfaces bound them.
    void expectPyramid(const TileId& id, const Grid<uint16_t>& codes) {
        const Grid<uint16_t> pairs = readLevel(tiles_, id, 1);
        uint16_t greatest = 0;
        int64_t wrong = 0, above = 0;
        for (int64_t y = 0; y < kTileCore / 2; ++y)
            for (int64_t x = 0; x < kTileCore / 2; ++x) {
                uint16_t most = 0;
                for (int64_t row = 2 * y - 1; row < 2 * y + 3; ++row)
                    for (int64_t column = 2 * x - 1; column < 2 * x + 3; ++column)
                        most = std::max(most, codes.at(column + kHeightApron, row + kHeightApron));
                wrong += pairs.at(x, y) != most;
                const double corner[2] = {2.0 * static_cast<double>(x), 2.0 * static_cast<double>(y)};
                above += tiles_.heights(id)->maxima.over(corner[0], corner[1], 2) < most;
                greatest = std::max(greatest, most);
            }
        EXPECT_EQ(wrong, 0);
        EXPECT_EQ(above, 0);
        EXPECT_EQ(readLevel(tiles_, id, 9).at(0, 0), greatest);
    }
};

TEST_F(TileEditorTest, CodesAreThoseOfTheClosedForm) {
    for (const uint32_t level : {3u, 1u}) {
        const TileId id{level, 1, 1};
        const HeightTile tile = hillsTile(id);
        for (const int count : {3, 12}) {
            const EditList edits = someEdits(level, kTiling.bounds(id), count);
            EXPECT_GT(expectEdited(tile, EditedGround(kTiling, kQuantum, edits)), 100);
        }
    }
}

TEST_F(TileEditorTest, ExtremeEditsClipNothing) {
    const TileId id{3, 0, 0};  // the dataset's corner
    const HeightTile tile = hillsTile(id);
    const glm::dvec2 corner(kTiling.west, kTiling.north), inside = sampleCentre(kTiling, id, 300, 300);
    using Kind = TerrainEdit::Kind;
    const auto crater = [](glm::dvec2 at, double radius, double depth, double rim) {
        return TerrainEdit{.kind = Kind::crater, .line = {{at, at}}, .radius = radius, .height = depth, .rim = rim};
    };
    const std::vector<EditList> lists = {
        {crater(inside, 300, 9000, 2500)},
        {crater(corner, 400, 50, 20)},
        {crater(corner + glm::dvec2(-250, 250), 400, 50, 20)},  // its centre outside the dataset
        {crater(inside, 0.5, 30, 0)},                           // smaller than a sample
        {crater(inside, 1e6, 4000, 900)},                       // larger than the dataset
        {crater(inside, 300, 9000, 0), crater(inside, 280, 9000, 0), crater(inside, 290, 9000, 0)},
        {{.kind = Kind::level, .line = {{corner, inside}}, .radius = 500, .full = 499, .height = -430}},
        {{.kind = Kind::level, .line = {{corner, inside}}, .radius = 500, .full = 100, .height = 8849.005}},
        {{.kind = Kind::raise, .line = {{corner, inside}}, .radius = 500, .full = 0, .height = 20'000}},
    };
    for (size_t n = 0; n < lists.size(); ++n) {
        SCOPED_TRACE(n);
        EXPECT_GT(expectEdited(tile, EditedGround(kTiling, kQuantum, lists[n])), 0);
    }
}

TEST_F(TileEditorTest, NeighboursAgreeOnSharedSamplesToTheLastBit) {
    const TileId west{3, 2, 3}, east{3, 3, 3};
    const HeightTile stored[2] = {hillsTile(west), hillsTile(east)};
    const GroundRect around = {kTiling.bounds(west).west, kTiling.bounds(west).south, kTiling.bounds(east).east,
                               kTiling.bounds(east).north};
    int64_t moved = 0;
    for (uint32_t seed = 20; seed < 23; ++seed) {
        const EditedGround ground(kTiling, kQuantum, someEdits(seed, around, 20));
        for (const HeightTile& tile : stored) {
            const auto edited = ground.describe(tile);
            ASSERT_TRUE(tiles_.uploadHeights(tile, edited ? &*edited : nullptr).done);
        }
        const Grid<uint16_t> left = readLevel(tiles_, west, 0), right = readLevel(tiles_, east, 0);
        const HeightEncoding &a = tiles_.heights(west)->encoding, &b = tiles_.heights(east)->encoding;
        const double apart = a.exponent == b.exponent ? 0 : (a.metresPerCode() + b.metresPerCode()) / 2;
        for (int64_t y = 0; y < kHeightTileSide; ++y)
            for (int64_t x = 0; x < 2 * kHeightApron; ++x) {
                const uint16_t p = left.at(kTileCore + x, y), q = right.at(x, y);
                ASSERT_EQ(p == kNoSurface, q == kNoSurface);
                if (p == kNoSurface) continue;
                ASSERT_NEAR(a.height(p), b.height(q), apart) << seed << ' ' << x << ' ' << y;
                moved += a.height(p) != stored[0].encoding.height(stored[0].codes.at(kTileCore + x, y));
            }
    }
    EXPECT_GT(moved, 2000);
}

TEST_F(TileEditorTest, ATileUploadedAgainWithoutEditsIsAsItWas) {
    const HeightTile tile = hillsTile({3, 1, 1});
    expectEdited(tile, EditedGround(kTiling, kQuantum, someEdits(9, kTiling.bounds(tile.id), 9)));
    ASSERT_TRUE(tiles_.uploadHeights(tile).done);
    EXPECT_TRUE(readLevel(tiles_, tile.id, 0) == tile.codes);
    EXPECT_EQ(tiles_.heights(tile.id)->encoding, tile.encoding);
    expectPyramid(tile.id, tile.codes);
}

TEST_F(TileEditorTest, WithoutEditsNoShaderIsCompiledAndNoBufferMade) {
    const test::TemporaryDirectory directory;
    std::ofstream(directory / "edit.comp") << "#error it is compiled\n";
    const ShaderLibrary broken(directory.path());
    GpuTiles tiles(broken, {.heightTiles = 4});
    const HeightTile tile = hillsTile({3, 1, 1});
    EXPECT_TRUE(tiles.uploadHeights(tile).done);
    EXPECT_EQ(tiles.editBufferBytes(), 0u);
    const auto edited = EditedGround(kTiling, kQuantum, someEdits(9, kTiling.bounds(tile.id), 9)).describe(tile);
    EXPECT_THROW((void)tiles.uploadHeights(tile, &*edited), Error);
}

TEST_F(TileEditorTest, AnEvictedTileLeavesItsSlotToAnother) {
    GpuTiles tiles(shaders_, {.heightTiles = 1});
    const HeightTile first = hillsTile({3, 1, 1}), second = hillsTile({3, 2, 1});
    ASSERT_TRUE(tiles.uploadHeights(first).done);
    tiles.pinHeights(first.id);
    EXPECT_FALSE(tiles.uploadHeights(second).done);
    tiles.evictHeights(second.id);  // not resident: nothing happens
    EXPECT_EQ(tiles.heightTiles(), std::vector<TileId>{first.id});
    tiles.evictHeights(first.id);
    EXPECT_EQ(tiles.heights(first.id), nullptr);
    EXPECT_EQ(tiles.residentHeights(), 0u);
    const GpuTiles::Upload upload = tiles.uploadHeights(second);
    EXPECT_TRUE(upload.done);
    EXPECT_FALSE(upload.evicted);
}

}  // namespace
}  // namespace terray
