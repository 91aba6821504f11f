#include "client/render/gpu_tiles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <glm/vec4.hpp>

#include "common/imagery_tile.h"
#include "common/tiling.h"
#include "tests/render/gl_test.h"

namespace terray {
namespace {

constexpr int kLevels = 10;

TileId tileAt(uint32_t x) {
    return {.level = 8, .x = x, .y = 3};
}

HeightTile tileOf(const TileId& id, Grid<uint16_t> codes) {
    HeightTile tile;
    tile.id = id;
    tile.codes = std::move(codes);
    return tile;
}

Grid<uint16_t> constantCodes(uint16_t code) {
    return Grid<uint16_t>({kHeightTileSide, kHeightTileSide}, code);
}

/// Random codes, a share of them holes. The apron holds the greatest code, so that a maximum which looks beyond the
/// core is seen.
Grid<uint16_t> randomCodes(uint32_t seed, double holes) {
    std::mt19937 random(seed);
    Grid<uint16_t> codes = constantCodes(65535);
    const GridView<uint16_t> core = codes.view().window({kHeightApron, kHeightApron, kTileCore, kTileCore});
    const auto holeBelow = static_cast<uint32_t>(holes * 65536);
    for (int y = 0; y < kTileCore; ++y) {
        for (uint16_t& code : core.row(y)) {
            const auto bits = static_cast<uint32_t>(random());
            code = (bits >> 16) < holeBelow ? kNoSurface : static_cast<uint16_t>(bits % 65000);
        }
    }
    return codes;
}

/// A level of the height array as it is on the GPU, margin and all.
Grid<uint16_t> readLevel(const GpuTiles& tiles, uint32_t slot, int level) {
    const int side = kHeightTileSide >> level;
    Grid<uint16_t> texels({side, side});
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTextureSubImage(tiles.heightTexture(), level, 0, 0, static_cast<GLint>(slot), side, side, 1, GL_RED_INTEGER,
                         GL_UNSIGNED_SHORT, static_cast<GLsizei>(texels.cells().size_bytes()), texels.cells().data());
    return texels;
}

/// The maximum of every block and the ring of codes around it, computed from the codes themselves and not from level to
/// level.
Grid<uint16_t> expectedLevel(const Grid<uint16_t>& codes, int level) {
    const int side = kHeightTileSide >> level;
    Grid<uint16_t> maxima({side, side});
    for (int y = -1; y <= kTileCore; ++y) {
        for (int x = -1; x <= kTileCore; ++x) {
            const uint16_t code = codes.at(x + kHeightApron, y + kHeightApron);
            for (const int row : {(y - 1) >> level, y >> level, (y + 1) >> level}) {
                for (const int column : {(x - 1) >> level, x >> level, (x + 1) >> level}) {
                    if (row < 0 || column < 0 || row >= kTileCore >> level || column >= kTileCore >> level) continue;
                    uint16_t& greatest = maxima.at(column, row);
                    greatest = std::max(greatest, code);
                }
            }
        }
    }
    return maxima;
}

/// Expects a slot to hold a tile: its codes, and of every level above the exact maxima, zeros beyond.
void expectHolds(const GpuTiles& tiles, const HeightTile& tile) {
    const ResidentHeights* resident = tiles.heights(tile.id);
    ASSERT_NE(resident, nullptr) << tile.id;
    EXPECT_TRUE(readLevel(tiles, resident->slot, 0) == tile.codes) << tile.id;
    for (int level = 1; level < kLevels; ++level) {
        EXPECT_TRUE(readLevel(tiles, resident->slot, level) == expectedLevel(tile.codes, level))
            << tile.id << " level " << level;
    }
}

class GpuTilesTest : public GlTest {
  protected:
    /// Room for some height tiles, and for imagery if asked.
    GpuTiles withSlots(uint64_t heightTiles, uint64_t imageryTiles = 0) {
        return GpuTiles(shaders_, {.heightTiles = heightTiles, .imageryTiles = imageryTiles});
    }
    ShaderLibrary shaders_;
};

TEST_F(GpuTilesTest, MaximaEqualTheCpus) {
    GpuTiles tiles = withSlots(1);
    uint32_t seed = 1;
    for (const double holes : {0.0, 0.02, 0.5, 0.999}) {
        const HeightTile tile = tileOf(tileAt(0), randomCodes(seed++, holes));
        ASSERT_TRUE(tiles.uploadHeights(tile).done);
        expectHolds(tiles, tile);
    }
}

TEST_F(GpuTilesTest, MaximaOfConstantTilesAndOfHolesAreThemselves) {
    GpuTiles tiles = withSlots(1);
    for (const uint16_t code : {kNoSurface, uint16_t{1}, uint16_t{32768}, uint16_t{65535}}) {
        const HeightTile tile = tileOf(tileAt(0), constantCodes(code));
        ASSERT_TRUE(tiles.uploadHeights(tile).done);
        expectHolds(tiles, tile);
        EXPECT_EQ(readLevel(tiles, 0, kLevels - 1).at(0, 0), code);
    }
}

TEST_F(GpuTilesTest, EveryMaximumBoundsWhatLiesUnderIt) {
    GpuTiles tiles = withSlots(1);
    ASSERT_TRUE(tiles.uploadHeights(tileOf(tileAt(0), randomCodes(9, 0.1))).done);
    const Grid<uint16_t> codes = readLevel(tiles, 0, 0);
    for (int level = 1; level < kLevels; ++level) {
        const Grid<uint16_t> maxima = readLevel(tiles, 0, level);
        int64_t uncovered = 0;
        for (int y = 0; y < kTileCore; ++y) {
            for (int x = 0; x < kTileCore; ++x) {
                // The bilinear surface over a cell leans on the cells around it.
                for (int dy = -1; dy <= 1; ++dy)
                    for (int dx = -1; dx <= 1; ++dx)
                        uncovered +=
                            maxima.at(x >> level, y >> level) < codes.at(x + dx + kHeightApron, y + dy + kHeightApron);
            }
        }
        EXPECT_EQ(uncovered, 0) << "level " << level;
    }
}

TEST_F(GpuTilesTest, ASinglePeakIsSeenFromEveryLevelAndNowhereElse) {
    GpuTiles tiles = withSlots(1);
    std::vector<std::array<int, 2>> positions;
    // Corners, both sides of work groups' borders, then anywhere.
    for (const int y : {0, 31, 32, 511}) {
        for (const int x : {0, 3, 4, 255, 256, 511}) positions.push_back({x, y});
    }
    std::mt19937 random(5);
    for (int i = 0; i < 24; ++i) {
        positions.push_back({static_cast<int>(random() % kTileCore), static_cast<int>(random() % kTileCore)});
    }
    for (const auto& [x, y] : positions) {
        Grid<uint16_t> codes = constantCodes(kNoSurface);
        codes.at(x + kHeightApron, y + kHeightApron) = 4321;
        ASSERT_TRUE(tiles.uploadHeights(tileOf(tileAt(0), codes)).done);
        for (int level = 1; level < kLevels; ++level) {
            const Grid<uint16_t> maxima = readLevel(tiles, 0, level);
            EXPECT_EQ(maxima.at(x >> level, y >> level), 4321) << x << ", " << y << " level " << level;
            EXPECT_TRUE(maxima == expectedLevel(codes, level)) << x << ", " << y << " level " << level;
        }
    }
}

TEST_F(GpuTilesTest, SlotsDoNotDisturbEachOther) {
    GpuTiles tiles = withSlots(4);
    ASSERT_EQ(tiles.heightSlots(), 4u);
    std::vector<HeightTile> uploaded;
    for (uint32_t i = 0; i < 4; ++i) {
        uploaded.push_back(tileOf(tileAt(i), randomCodes(100 + i, 0.1)));
        ASSERT_TRUE(tiles.uploadHeights(uploaded.back()).done);
    }
    for (const HeightTile& tile : uploaded) expectHolds(tiles, tile);
}

TEST_F(GpuTilesTest, AReusedSlotKeepsNothingOfItsFormerTile) {
    GpuTiles tiles = withSlots(2);
    const HeightTile staying = tileOf(tileAt(0), randomCodes(1, 0));
    ASSERT_TRUE(tiles.uploadHeights(staying).done);
    ASSERT_TRUE(tiles.uploadHeights(tileOf(tileAt(1), constantCodes(65535))).done);
    tiles.touchHeights(staying.id);
    const HeightTile low = tileOf(tileAt(2), constantCodes(2));
    const GpuTiles::Upload upload = tiles.uploadHeights(low);
    ASSERT_TRUE(upload.done);
    EXPECT_EQ(upload.evicted, tileAt(1));
    EXPECT_EQ(tiles.heights(tileAt(1)), nullptr);
    EXPECT_EQ(tiles.residentHeights(), 2u);
    expectHolds(tiles, low);
    expectHolds(tiles, staying);
}

TEST_F(GpuTilesTest, KnowsEncodingAndRecordOfAResidentTile) {
    GpuTiles tiles = withSlots(2);
    HeightTile tile = tileOf(tileAt(7), constantCodes(100));
    tile.encoding = {.quantum = 0.05, .exponent = 3, .offset = -77};
    tile.record = {.exists = true, .hasHoles = false, .minHeight = 1, .maxHeight = 2, .error = 0.5F};
    ASSERT_TRUE(tiles.uploadHeights(tile).done);
    const ResidentHeights* resident = tiles.heights(tileAt(7));
    ASSERT_NE(resident, nullptr);
    EXPECT_EQ(resident->encoding, tile.encoding);
    EXPECT_EQ(resident->record, tile.record);
    EXPECT_EQ(tiles.heights(tileAt(8)), nullptr);
    // The same tile again, changed: in its old place.
    tile.record.error = 0.25F;
    tile.codes = constantCodes(50);
    const GpuTiles::Upload again = tiles.uploadHeights(tile);
    EXPECT_TRUE(again.done);
    EXPECT_FALSE(again.evicted);
    EXPECT_EQ(tiles.heights(tileAt(7))->record.error, 0.25F);
    EXPECT_EQ(tiles.residentHeights(), 1u);
    expectHolds(tiles, tile);
}

TEST_F(GpuTilesTest, HasNoSlotWhenAllArePinned) {
    GpuTiles tiles = withSlots(2, 1);
    const Bytes chain(imageryChainBytes());
    for (uint32_t i = 0; i < 2; ++i) {
        ASSERT_TRUE(tiles.uploadHeights(tileOf(tileAt(i), constantCodes(1))).done);
        tiles.pinHeights(tileAt(i));
    }
    ASSERT_TRUE(tiles.uploadImagery(tileAt(0), chain).done);
    tiles.pinImagery(tileAt(0));
    EXPECT_FALSE(tiles.uploadHeights(tileOf(tileAt(2), constantCodes(1))).done);
    EXPECT_FALSE(tiles.uploadImagery(tileAt(2), chain).done);
    EXPECT_NE(tiles.heights(tileAt(0)), nullptr);
    EXPECT_NE(tiles.heights(tileAt(1)), nullptr);
    EXPECT_EQ(tiles.heights(tileAt(2)), nullptr);
    EXPECT_FALSE(tiles.imagerySlot(tileAt(2)));
    tiles.beginFrame();
    EXPECT_EQ(tiles.uploadHeights(tileOf(tileAt(2), constantCodes(1))).evicted, tileAt(0));
    EXPECT_EQ(tiles.uploadImagery(tileAt(2), chain).evicted, tileAt(0));
}

TEST_F(GpuTilesTest, PinningWhatIsNotResidentIsMisuseTouchingItIsNot) {
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
    GpuTiles tiles = withSlots(1);
    tiles.touchHeights(tileAt(0));
    tiles.touchImagery(tileAt(0));
    EXPECT_DEATH(tiles.pinHeights(tileAt(0)), "check failed");
    EXPECT_DEATH(tiles.pinImagery(tileAt(0)), "check failed");
}

TEST_F(GpuTilesTest, BudgetsAndTileCountsBoundTheSlots) {
    constexpr uint64_t kMaxima = 2 * (258 * 258 + 129 * 129 + 64 * 64 + 32 * 32 + 16 * 16 + 8 * 8 + 4 * 4 + 2 * 2 + 1);
    constexpr uint64_t kHeightSlot = GpuTiles::heightUploadBytes() + kMaxima;
    constexpr uint64_t kImagerySlot = GpuTiles::imageryUploadBytes();
    const GpuTiles tiles(shaders_, {.heightBudgetBytes = 5 * kHeightSlot,
                                    .imageryBudgetBytes = 4 * kImagerySlot - 1,
                                    .heightTiles = 1000,
                                    .imageryTiles = 1000});
    EXPECT_EQ(tiles.heightSlots(), 5u);
    EXPECT_EQ(tiles.imagerySlots(), 3u);
    EXPECT_EQ(tiles.allocatedBytes().heights, 5 * GpuTiles::heightUploadBytes());
    EXPECT_EQ(tiles.allocatedBytes().maxima, 5 * kMaxima);
    EXPECT_EQ(tiles.allocatedBytes().imagery, 3 * kImagerySlot);
    const GpuTiles starved(shaders_,
                           {.heightBudgetBytes = 0, .imageryBudgetBytes = 0, .heightTiles = 9, .imageryTiles = 9});
    EXPECT_EQ(starved.heightSlots(), 1u);
    EXPECT_EQ(starved.imagerySlots(), 1u);
}

TEST_F(GpuTilesTest, WithoutImageryNothingOfItExists) {
    const GpuTiles tiles = withSlots(3);
    EXPECT_EQ(tiles.imageryTexture(), 0u);
    EXPECT_EQ(tiles.imagerySlots(), 0u);
    EXPECT_EQ(tiles.allocatedBytes().imagery, 0u);
    EXPECT_EQ(tiles.residentImagery(), 0u);
}

// --- Imagery ---------------------------------------------------------------------------------------------------------

/// The colour of one BC1 block: red, green, blue of 5, 6, 5 bits.
uint16_t blockColour(uint32_t seed, int mip, int64_t x, int64_t y) {
    std::minstd_rand random(seed * 1000003u + static_cast<uint32_t>(mip * 65536 + y * 256 + x) + 1u);
    return static_cast<uint16_t>(random() >> 8);
}

/// A chain whose every block has one colour.
Bytes flatBlocks(uint32_t seed) {
    ByteWriter chain;
    for (int mip = 0; mip < kImageryMips; ++mip) {
        const int blocks = imageryMipSide(mip) / 4;
        for (int y = 0; y < blocks; ++y) {
            for (int x = 0; x < blocks; ++x) {
                const uint16_t colour = blockColour(seed, mip, x, y);
                chain.write(colour);
                chain.write(colour);
                chain.write(uint32_t{0});  // every texel is the first colour
            }
        }
    }
    return chain.release();
}

/// 8-bit sRGB of a 5-, 6- or 5-bit channel, by repeating its upper bits.
std::array<int, 3> srgbOf565(uint16_t colour) {
    const int red = colour >> 11;
    const int green = (colour >> 5) & 63;
    const int blue = colour & 31;
    return {red << 3 | red >> 2, green << 2 | green >> 4, blue << 3 | blue >> 2};
}

double srgbFromLinear(double linear) {
    return 255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
}

constexpr const char* kFetchShader = R"glsl(
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2DArray photos;
layout(binding = 0, rgba32f) writeonly uniform image2D fetched;
layout(location = 0) uniform int slot;
layout(location = 1) uniform int mip;
void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    imageStore(fetched, texel, texelFetch(photos, ivec3(texel, slot), mip));
}
)glsl";

/// What a shader sees of one mip of a slot: linear colours.
Grid<glm::vec4> fetchMip(GLuint program, const GpuTiles& tiles, uint32_t slot, int mip) {
    const int side = imageryMipSide(mip);
    const GlTexture image = makeTexture(GL_TEXTURE_2D);
    glTextureStorage2D(image.name(), 1, GL_RGBA32F, side, side);
    glUseProgram(program);
    glBindTextureUnit(0, tiles.imageryTexture());
    glBindImageTexture(0, image.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32F);
    glUniform1i(0, static_cast<GLint>(slot));
    glUniform1i(1, mip);
    glDispatchCompute(static_cast<GLuint>(side / 8), static_cast<GLuint>(side / 8), 1);
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    Grid<glm::vec4> texels({side, side});
    glGetTextureImage(image.name(), 0, GL_RGBA, GL_FLOAT, static_cast<GLsizei>(texels.cells().size_bytes()),
                      texels.cells().data());
    return texels;
}

/// Expects every texel of every mip to be what flatBlocks(seed) says, within one step of 8 bits: decoders may round.
void expectShows(GLuint program, const GpuTiles& tiles, const TileId& id, uint32_t seed) {
    const auto slot = tiles.imagerySlot(id);
    ASSERT_TRUE(slot) << id;
    for (int mip = 0; mip < kImageryMips; ++mip) {
        const Grid<glm::vec4> texels = fetchMip(program, tiles, *slot, mip);
        int64_t wrong = 0;
        for (int64_t y = 0; y < texels.height(); ++y) {
            for (int64_t x = 0; x < texels.width(); ++x) {
                const std::array<int, 3> expected = srgbOf565(blockColour(seed, mip, x / 4, y / 4));
                const glm::vec4& found = texels.at(x, y);
                for (int channel = 0; channel < 3; ++channel) {
                    wrong += std::abs(srgbFromLinear(found[channel]) - expected[static_cast<size_t>(channel)]) > 1.0;
                }
            }
        }
        EXPECT_EQ(wrong, 0) << id << " mip " << mip;
    }
}

TEST_F(GpuTilesTest, ImageryIsFetchedAsItWasEncodedFromEveryMipAndSlot) {
    const ShaderFolder folder(ShaderFiles{{"fetch.comp", kFetchShader}});
    const GlProgram program = ShaderLibrary(folder.path()).require({"fetch.comp"}, {});
    GpuTiles tiles = withSlots(1, 3);
    for (uint32_t i = 0; i < 3; ++i) ASSERT_TRUE(tiles.uploadImagery(tileAt(i), flatBlocks(i)).done);
    for (uint32_t i = 0; i < 3; ++i) expectShows(program.name(), tiles, tileAt(i), i);
    // A fourth takes the place of the oldest.
    const GpuTiles::Upload upload = tiles.uploadImagery(tileAt(3), flatBlocks(3));
    ASSERT_TRUE(upload.done);
    EXPECT_EQ(upload.evicted, tileAt(0));
    EXPECT_FALSE(tiles.imagerySlot(tileAt(0)));
    for (uint32_t i = 1; i < 4; ++i) expectShows(program.name(), tiles, tileAt(i), i);
    EXPECT_EQ(tiles.residentImagery(), 3u);
}

TEST_F(GpuTilesTest, ImageryOfAnotherSizeIsMisuse) {
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
    GpuTiles tiles = withSlots(1, 1);
    EXPECT_DEATH(tiles.uploadImagery(tileAt(0), Bytes(imageryChainBytes() - 1)), "check failed");
    GpuTiles without = withSlots(1, 0);
    EXPECT_DEATH(without.uploadImagery(tileAt(0), Bytes(imageryChainBytes())), "check failed");
}

}  // namespace
}  // namespace terray
