// The pushed-up mesh over a tile (paper 002, section 3) lies above all of its ground, whatever the ground.

#include "client/render/hull_tiles.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "client/render/gpu_tiles.h"
#include "tests/render/gl_test.h"

namespace terray {
namespace {

using Codes = std::function<int(int column, int row)>;

HeightTile tileOf(const Codes& code) {
    HeightTile tile;
    tile.codes = Grid<uint16_t>({kHeightTileSide, kHeightTileSide});
    for (int y = 0; y < kHeightTileSide; ++y)
        for (int x = 0; x < kHeightTileSide; ++x)
            tile.codes.at(x, y) = static_cast<uint16_t>(code(x - kHeightApron, y - kHeightApron));
    return tile;
}

struct Hull {
    int side = 0;
    std::vector<float> heights;

    /// The mesh's height, by its two triangles; on the diagonal both are the same.
    [[nodiscard]] double at(double x, double y) const {
        const double u = x * side / kTileCore, v = y * side / kTileCore;
        const int i = std::min(static_cast<int>(u), side - 1), j = std::min(static_cast<int>(v), side - 1);
        const auto h = [&](int column, int row) {
            return double{heights[static_cast<size_t>((j + row) * (side + 1) + i + column)]};
        };
        const double a = u - i, b = v - j;
        if (a + b <= 1) return h(0, 0) + a * (h(1, 0) - h(0, 0)) + b * (h(0, 1) - h(0, 0));
        return h(1, 1) + (1 - a) * (h(0, 1) - h(1, 1)) + (1 - b) * (h(1, 0) - h(1, 1));
    }
};

class HullTilesTest : public GlTest {
  protected:
    Hull hullOf(const HeightTile& tile, int side) {
        const MethodOptions method{.method = Method::hull, .quads = static_cast<double>(side)};
        GpuTiles tiles(shaders_, {.heightTiles = 1, .method = {.method = method}});
        EXPECT_TRUE(tiles.uploadHeights(tile).done);
        const auto& hulls = dynamic_cast<const HullTiles&>(*tiles.methodTiles());
        EXPECT_EQ(tiles.allocatedBytes().method, hulls.bytes());
        Hull hull{.side = side, .heights = std::vector<float>(static_cast<size_t>((side + 1) * (side + 1)))};
        glGetTextureImage(hulls.texture(), 0, GL_RED, GL_FLOAT, static_cast<GLsizei>(4 * hull.heights.size()),
                          hull.heights.data());
        return hull;
    }
    /// Expects every column (its four corners) and every patch (at many places) below the mesh.
    static void expectAbove(const Hull& hull, const HeightTile& tile) {
        const auto code = [&](int x, int y) {
            return static_cast<double>(tile.codes.at(x + kHeightApron, y + kHeightApron));
        };
        int below = 0, looked = 0;
        for (int y = 0; y < kTileCore; ++y)
            for (int x = 0; x < kTileCore; ++x) {
                if (code(x, y) == 0) continue;
                for (const int corner : {0, 1, 2, 3})
                    below += hull.at(x + (corner & 1), y + (corner >> 1)) < code(x, y) ? 1 : 0;
                // The patch to the south-east, where all four of its samples are ground.
                const double h00 = code(x, y), h10 = code(x + 1, y), h01 = code(x, y + 1), h11 = code(x + 1, y + 1);
                if (x + 1 == kTileCore || y + 1 == kTileCore || std::min({h10, h01, h11}) == 0) continue;
                for (const double v : {0.0, 0.3, 0.5, 0.8})
                    for (const double u : {0.0, 0.2, 0.5, 0.9}) {
                        const double ground = (h00 * (1 - u) + h10 * u) * (1 - v) + (h01 * (1 - u) + h11 * u) * v;
                        below += hull.at(x + 0.5 + u, y + 0.5 + v) < ground ? 1 : 0;
                        ++looked;
                    }
            }
        EXPECT_EQ(below, 0) << "of " << looked << " with " << hull.side << " quads";
    }
    ShaderLibrary shaders_;
};

TEST_F(HullTilesTest, NoSampleOfRoughGroundLiesAboveIt) {
    std::mt19937 random(7);
    std::vector<int> noise(static_cast<size_t>(kHeightTileSide) * kHeightTileSide);
    for (int& value : noise) value = static_cast<int>(random() % 65535) + 1;
    const auto at = [&](int x, int y) {
        return noise[static_cast<size_t>((y + kHeightApron) * kHeightTileSide + x + kHeightApron)];
    };
    const Codes hills = [](int x, int y) {
        return static_cast<int>(30000 + 20000 * std::sin(x / 31.0) * std::cos(y / 47.0) + 900 * std::sin(x * y / 97.0));
    };
    const Codes holed = [&](int x, int y) { return at(x, y) % 5 < 2 ? 0 : at(x, y); };
    const Codes spike = [](int x, int y) { return x == 255 && y == 256 ? 65535 : 1; };
    for (const Codes& codes : {Codes(at), hills, holed, spike}) {
        const HeightTile tile = tileOf(codes);
        for (const int side : {16, 32, 64, 128, 256}) expectAbove(hullOf(tile, side), tile);
    }
}

TEST_F(HullTilesTest, OverAPlaneItIsThePlaneToAStepOfASample) {
    // 20 codes a column to the east, 10 a row to the south: a cell's corner may be a cell's rise above its centre.
    const HeightTile tile = tileOf([](int x, int y) { return 1000 + 20 * (x + 2) + 10 * (y + 2); });
    const Hull hull = hullOf(tile, 32);
    expectAbove(hull, tile);
    for (int y = 0; y < kTileCore; y += 7)
        for (int x = 0; x < kTileCore; x += 5)
            EXPECT_NEAR(hull.at(x + 0.5, y + 0.5), 1000 + 20 * (x + 2) + 10 * (y + 2), 2 * 30.0) << x << ' ' << y;
}

TEST_F(HullTilesTest, MoreQuadsLieCloser) {
    const HeightTile tile =
        tileOf([](int x, int y) { return static_cast<int>(30000 + 9000 * std::sin(x / 17.0) * std::cos(y / 23.0)); });
    double last = 1e30;
    for (const int side : {16, 64, 256}) {
        const Hull hull = hullOf(tile, side);
        double sum = 0;
        for (int y = 0; y < kTileCore; y += 3)
            for (int x = 0; x < kTileCore; x += 3)
                sum += hull.at(x + 0.5, y + 0.5) - tile.codes.at(x + kHeightApron, y + kHeightApron);
        EXPECT_LT(sum, 0.6 * last);
        last = sum;
    }
}

}  // namespace
}  // namespace terray
