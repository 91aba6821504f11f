// Relaxed cones over a tile: nothing narrows them over a plain, and a lone tower narrows those around it by its
// distance.

#include "client/render/cone_tiles.h"

#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "client/render/gpu_tiles.h"
#include "tests/render/gl_test.h"

namespace terray {
namespace {

constexpr int kBlocks = 128;
constexpr int kBlockSide = kTileCore / kBlocks;

class ConeTilesTest : public GlTest {
  protected:
    std::vector<float> conesOf(const std::function<int(int column, int row)>& code) {
        HeightTile tile;
        tile.codes = Grid<uint16_t>({kHeightTileSide, kHeightTileSide});
        for (int y = 0; y < kHeightTileSide; ++y)
            for (int x = 0; x < kHeightTileSide; ++x)
                tile.codes.at(x, y) = static_cast<uint16_t>(code(x - kHeightApron, y - kHeightApron));
        GpuTiles tiles(shaders_, {.heightTiles = 1, .method = {.method = {.method = Method::cones}}});
        EXPECT_TRUE(tiles.uploadHeights(tile).done);
        const auto& cones = dynamic_cast<const ConeTiles&>(*tiles.methodTiles());
        EXPECT_EQ(tiles.allocatedBytes().method, uint64_t{2} * kBlocks * kBlocks);
        std::vector<float> widths(static_cast<size_t>(kBlocks) * kBlocks);
        glGetTextureImage(cones.texture(), 0, GL_RED, GL_FLOAT, static_cast<GLsizei>(4 * widths.size()), widths.data());
        return widths;
    }
    static float at(const std::vector<float>& widths, int x, int y) {
        return widths[static_cast<size_t>(y * kBlocks + x)];
    }
    ShaderLibrary shaders_;
};

TEST_F(ConeTilesTest, OverAPlainEveryConeIsOpen) {
    for (const float width : conesOf([](int, int) { return 700; })) EXPECT_GT(width, 4000);
}

TEST_F(ConeTilesTest, ATowerBoundsTheConesAroundItByWhereRaysThroughItComeOut) {
    // 1000 codes over the plain, block (64, 64) whole, and by the ring of samples its neighbours' maxima; far away a
    // summit of 2000, from whose height rays start.
    const auto widths = conesOf([](int x, int y) {
        if (x / kBlockSide == 64 && y / kBlockSide == 64) return 1001;
        return x < kBlockSide && y < kBlockSide && x >= 0 && y >= 0 ? 2001 : 1;
    });
    // From 10 blocks west: the ray through block 65, 11 blocks on, has sunk 1000 codes there and leaves a block later,
    // after 1000 / 11 more. A block's side is taken off, for rays that start at its far end.
    const double relaxed = 11 * kBlockSide / (1000 - 1000 / 11.0);
    EXPECT_NEAR(at(widths, 54, 64), relaxed, 0.01 * relaxed);
    EXPECT_NEAR(at(widths, 64, 54), relaxed, 0.01 * relaxed);
    EXPECT_GT(at(widths, 54, 64), 1.4 * 8 * kBlockSide / 1000.0) << "a cone that no ray enters ground in is narrower";
    EXPECT_GT(at(widths, 40, 64), 4000) << "beyond the reach of 16 blocks";
    for (int x = 50; x < 62; ++x) EXPECT_LE(at(widths, x + 1, 64), at(widths, x, 64)) << "nearer is narrower";
}

}  // namespace
}  // namespace terray
