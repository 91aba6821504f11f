// Triangulations of height tiles: within their tolerance everywhere, without T-junctions, as few triangles as the
// ground allows.

#include "client/render/terrain_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <random>

#include <glm/vec2.hpp>
#include <gtest/gtest.h>

#include "common/height_tile.h"
#include "common/tiling.h"

namespace terray {
namespace {

using Codes = std::function<int(int column, int row)>;

Grid<uint16_t> codesOf(const Codes& code) {
    Grid<uint16_t> codes({kHeightTileSide, kHeightTileSide});
    for (int y = 0; y < kHeightTileSide; ++y)
        for (int x = 0; x < kHeightTileSide; ++x)
            codes.at(x, y) = static_cast<uint16_t>(code(x - kHeightApron, y - kHeightApron));
    return codes;
}

using Corners = std::array<glm::ivec2, 3>;

std::vector<Corners> trianglesOf(const TerrainMesh& mesh) {
    std::vector<Corners> triangles;
    for (int block = 0; block < TerrainMesh::kBlocks; ++block) {
        const glm::ivec2 corner = glm::ivec2(block % 4, block / 4) * TerrainMesh::kBlockSide - 1;
        for (size_t i = mesh.starts[static_cast<size_t>(block)]; i < mesh.starts[static_cast<size_t>(block) + 1];
             i += 3) {
            Corners corners;
            for (size_t k = 0; k < 3; ++k) {
                const int place = mesh.indices[i + k];
                corners[k] = corner + glm::ivec2(place % TerrainMesh::kBlockStride, place / TerrainMesh::kBlockStride);
            }
            triangles.push_back(corners);
        }
    }
    return triangles;
}

/// Twice the area; positive when counter-clockwise from above (rows run south).
int areaOf(const Corners& t) {
    const glm::ivec2 u = t[1] - t[0], v = t[2] - t[0];
    return -(u.x * v.y - u.y * v.x);
}

/// Of all samples in all triangles, the greatest distance; and how often each sample is covered by area.
struct Found {
    double greatest = 0;
    int64_t doubleArea = 0;
    bool clockwise = false;
};
Found measure(const TerrainMesh& mesh, const Grid<uint16_t>& codes) {
    const auto height = [&](glm::ivec2 v) {
        return static_cast<double>(codes.at(v.x + kHeightApron, v.y + kHeightApron));
    };
    Found found;
    for (const Corners& t : trianglesOf(mesh)) {
        const int area = areaOf(t);
        found.clockwise |= area <= 0;
        found.doubleArea += area;
        const auto [left, right] = std::minmax({t[0].x, t[1].x, t[2].x});
        const auto [top, bottom] = std::minmax({t[0].y, t[1].y, t[2].y});
        for (int y = top; y <= bottom; ++y)
            for (int x = left; x <= right; ++x) {
                const glm::ivec2 p(x, y);
                const int a = areaOf({p, t[1], t[2]}), b = areaOf({t[0], p, t[2]}), c = areaOf({t[0], t[1], p});
                if (std::min({a, b, c}) < 0) continue;
                const double plane = (a * height(t[0]) + b * height(t[1]) + c * height(t[2])) / area;
                found.greatest = std::max(found.greatest, std::abs(plane - height(p)));
            }
    }
    return found;
}

/// Edges of the mesh that only one triangle has, less those of its outline: none when it conforms.
int64_t looseEdges(const TerrainMesh& mesh) {
    std::map<std::array<int, 4>, int> edges;
    for (const Corners& t : trianglesOf(mesh))
        for (size_t k = 0; k < 3; ++k) {
            const glm::ivec2 a = t[k], b = t[(k + 1) % 3];
            edges[{a.x, a.y, b.x, b.y}] += 1;
            edges[{b.x, b.y, a.x, a.y}] -= 1;
        }
    return std::ranges::count_if(edges, [](const auto& entry) {
        const auto& [x0, y0, x1, y1] = entry.first;
        const bool outline = (x0 == x1 && (x0 == -1 || x0 == kTileCore)) || (y0 == y1 && (y0 == -1 || y0 == kTileCore));
        return entry.second != 0 && !outline;
    });
}

constexpr int64_t kDoubleArea = 2 * int64_t{kTileCore + 1} * (kTileCore + 1);

TEST(TerrainMesh, KeepsItsToleranceAtEverySampleAndConforms) {
    std::mt19937 random(3);
    const Codes hills = [](int x, int y) {
        return static_cast<int>(30000 + 8000 * std::sin(x / 31.0) * std::cos(y / 47.0) + 300 * std::sin(x * y / 97.0));
    };
    const Codes spike = [](int x, int y) { return x == 300 && y == 129 ? 60000 : 100; };
    const Codes borderSpike = [](int x, int y) { return (x == -1 && y == 77) || (y == -1 && x == 401) ? 9000 : 100; };
    const Codes noise = [&](int, int) { return static_cast<int>(random() % 2000) + 1; };
    for (const Codes& code : {hills, spike, borderSpike, noise}) {
        const Grid<uint16_t> codes = codesOf(code);
        size_t last = SIZE_MAX;
        for (const double tolerance : {0.0, 20.0, 500.0}) {
            const TerrainMesh mesh = triangulated(codes, {.codes = tolerance});
            const Found found = measure(mesh, codes);
            EXPECT_LE(found.greatest, tolerance + 0.02) << "float";
            EXPECT_EQ(found.doubleArea, kDoubleArea) << "gaps or overlaps";
            EXPECT_FALSE(found.clockwise);
            EXPECT_EQ(looseEdges(mesh), 0);
            EXPECT_LE(mesh.triangles(), last);
            last = mesh.triangles();
        }
    }
}

TEST(TerrainMesh, OfAPlaneTakesAsFewTrianglesAsBlocksAllow) {
    const Grid<uint16_t> codes = codesOf([](int x, int y) { return 5000 + 8 * x + 3 * y; });
    // Two a block, two for each of the 8 border edges of the strip, two at its corner.
    EXPECT_EQ(triangulated(codes, {.codes = 0.01}).triangles(), 2u * TerrainMesh::kBlocks + 2 * 8 + 2);
    EXPECT_GT(triangulated(codes, {.codes = 0.01, .sag = 1e-4}).triangles(), 1000u) << "edges that the earth bends";
}

TEST(TerrainMesh, TrianglesAreEstimatedToAFactorOfTwo) {
    std::mt19937 random(3);
    const Codes hills = [](int x, int y) {
        return static_cast<int>(30000 + 8000 * std::sin(x / 31.0) * std::cos(y / 47.0) + 300 * std::sin(x * y / 997.0));
    };
    const Codes noise = [&](int, int) { return static_cast<int>(random() % 2000) + 1; };
    const Codes holed = [&](int x, int y) { return (x / 50 + y / 50) % 3 == 0 ? 0 : hills(x, y); };
    for (const Codes& code : {hills, noise, holed}) {
        const Grid<uint16_t> codes = codesOf(code);
        for (const MeshTolerance& tolerance :
             {MeshTolerance{.codes = 1}, MeshTolerance{.codes = 60}, MeshTolerance{.codes = 60, .sag = 1}}) {
            const auto made = static_cast<double>(triangulated(codes, tolerance).triangles());
            ASSERT_GT(made, 3000);
            EXPECT_GT(estimatedTriangles(codes, tolerance), made / 2) << tolerance.codes << ' ' << tolerance.sag;
            EXPECT_LT(estimatedTriangles(codes, tolerance), made * 2) << tolerance.codes << ' ' << tolerance.sag;
        }
    }
}

TEST(TerrainMesh, LeavesOutHolesAndKeepsTheirRims) {
    const auto hole = [](int x, int y) { return x >= 100 && x < 140 && y >= 200 && y < 300; };
    const Grid<uint16_t> codes = codesOf([&](int x, int y) { return hole(x, y) ? 0 : 1000 + x; });
    const TerrainMesh mesh = triangulated(codes, {.codes = 1});
    int within = 0;
    for (const Corners& t : trianglesOf(mesh))
        for (const glm::ivec2 v : t) within += v.x >= 101 && v.x < 139 && v.y >= 201 && v.y < 299 ? 1 : 0;
    EXPECT_EQ(within, 0) << "no corner beyond the samples beside ground";
    // 39 x 99 squares touch a sample that neither is ground nor lies beside it; half of a corner square may be left.
    const int64_t leftOut = kDoubleArea - measure(mesh, codes).doubleArea;
    EXPECT_LE(leftOut, 2 * 39 * 99);
    EXPECT_GE(leftOut, 2 * 39 * 99 - 4);
    EXPECT_EQ(triangulated(codesOf([](int, int) { return 0; }), {}).triangles(), 0u);
}

}  // namespace
}  // namespace terray
