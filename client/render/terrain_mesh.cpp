#include "client/render/terrain_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include "common/check.h"
#include "common/height_tile.h"
#include "common/tiling.h"

namespace terray {
namespace {

constexpr int kSize = kTileCore;  // cells between the first and the last vertex of the hierarchy
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinite = std::numeric_limits<float>::infinity();

using Vertex = glm::ivec2;  // column and row of a sample

/// Heights of the samples -1 .. 512 of both axes, in codes; NaN where there is no surface and none beside it.
class Heights {
  public:
    explicit Heights(const Grid<uint16_t>& codes) : values_({kSize + 2, kSize + 2}) {
        for (int y = -1; y <= kSize; ++y)
            for (int x = -1; x <= kSize; ++x)
                values_.at(x + 1, y + 1) = heightOf(codes, x + kHeightApron, y + kHeightApron);
    }
    [[nodiscard]] float at(Vertex v) const { return values_.at(v.x + 1, v.y + 1); }
    [[nodiscard]] const float* row(int y) const { return values_.view().row(y + 1).data() + 1; }

  private:
    static float heightOf(const Grid<uint16_t>& codes, int x, int y) {
        if (codes.at(x, y) != kNoSurface) return codes.at(x, y);
        float sum = 0, count = 0;
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
                const uint16_t code = codes.at(x + dx, y + dy);
                sum += code;
                count += code != kNoSurface ? 1 : 0;
            }
        return count > 0 ? sum / count : kNone;
    }
    Grid<float> values_;
};

/// A triangle of the hierarchy: right angle at c, hypotenuse from a to b.
struct Triangle {
    Vertex a, b, c;
    [[nodiscard]] Vertex middle() const { return (a + b) / 2; }
    [[nodiscard]] int legSquared() const { return (a.x - c.x) * (a.x - c.x) + (a.y - c.y) * (a.y - c.y); }
};

/// All triangles that can be split, coarse ones first: the children of triangle i are 2 i + 2 and 2 i + 3.
const std::vector<Triangle>& hierarchy() {
    static const std::vector<Triangle> kTriangles = [] {
        std::vector<Triangle> all{{{0, 0}, {kSize, kSize}, {kSize, 0}}, {{kSize, kSize}, {0, 0}, {0, kSize}}};
        constexpr size_t kCount = 2 * (size_t{kSize} * kSize - 1);
        for (size_t i = 0; all.size() < kCount; ++i) {
            const Triangle parent = all[i];
            all.push_back({parent.c, parent.a, parent.middle()});
            all.push_back({parent.b, parent.c, parent.middle()});
        }
        return all;
    }();
    return kTriangles;
}

/// Greatest distance of a row's samples from a line over it; infinite when only some of them have a surface.
struct Spread {
    float greatest = 0;
    bool surface = false;
    bool none = false;
    void add(float height, float plane) {
        if (std::isnan(height)) {
            none = true;
            return;
        }
        surface = true;
        greatest = std::max(greatest, std::abs(height - plane));  // no change when the plane is NaN: a corner is none
    }
    [[nodiscard]] float value() const { return none && surface ? kInfinite : greatest; }
};

/// First and last column of a triangle's samples in a row; its edges run along rows, columns or diagonals.
std::pair<int, int> columnsOf(const Triangle& t, int y) {
    int first = std::numeric_limits<int>::max(), last = std::numeric_limits<int>::min();
    const auto take = [&](int x) {
        first = std::min(first, x);
        last = std::max(last, x);
    };
    const auto edge = [&](Vertex p, Vertex q) {
        if (p.y > q.y) std::swap(p, q);
        if (y < p.y || y > q.y) return;
        if (p.y == q.y) {
            take(p.x);
            take(q.x);
        } else {
            take(p.x + (y - p.y) * ((q.x - p.x) / (q.y - p.y)));
        }
    };
    edge(t.a, t.b);
    edge(t.b, t.c);
    edge(t.c, t.a);
    return {first, last};
}

float deviationOf(const Triangle& t, const Heights& heights) {
    // The plane as its height at c and its slopes: the legs are perpendicular and equally long.
    const float ha = heights.at(t.a), hb = heights.at(t.b), hc = heights.at(t.c);
    const Vertex u = t.a - t.c, v = t.b - t.c;
    const auto square = static_cast<float>(t.legSquared());
    const float slopeX = (static_cast<float>(u.x) * (ha - hc) + static_cast<float>(v.x) * (hb - hc)) / square;
    const float slopeY = (static_cast<float>(u.y) * (ha - hc) + static_cast<float>(v.y) * (hb - hc)) / square;
    Spread spread;
    const auto [top, bottom] = std::minmax({t.a.y, t.b.y, t.c.y});
    for (int y = top; y <= bottom; ++y) {
        const auto [first, last] = columnsOf(t, y);
        const float* row = heights.row(y);
        const float start = hc + static_cast<float>(y - t.c.y) * slopeY;
        for (int x = first; x <= last; ++x) spread.add(row[x], start + static_cast<float>(x - t.c.x) * slopeX);
    }
    return spread.value();
}

/// Errors of splits: a triangle is split when that of the middle of its hypotenuse exceeds the tolerance. Both
/// triangles that share a hypotenuse ask the same number, and none is below those of the splits beneath: so the mesh
/// conforms.
class SplitErrors {
  public:
    SplitErrors(const Heights& heights, double sag) : errors_({kSize + 1, kSize + 1}, 0.0f) {
        strip(heights, true);
        strip(heights, false);
        const std::vector<Triangle>& all = hierarchy();
        const size_t parents = all.size() / 2 - 1;  // whose children can be split in turn
        for (size_t i = all.size(); i-- > 0;) {
            const Triangle& t = all[i];
            const Vertex m = t.middle();
            const int hypotenuse = 2 * t.legSquared();  // squared
            float error = i < parents ? deviationOf(t, heights) : smallest(t, heights);
            error += static_cast<float>(sag * hypotenuse);
            if (i < parents) error = std::max({error, at((t.a + t.c) / 2), at((t.b + t.c) / 2)});
            raise(m, error);
        }
    }
    [[nodiscard]] float at(Vertex v) const { return errors_.at(v.x, v.y); }

  private:
    void raise(Vertex v, float error) { errors_.at(v.x, v.y) = std::max(at(v), error); }
    /// Of the smallest that can be split: its samples are the corners and the middle.
    static float smallest(const Triangle& t, const Heights& heights) {
        Spread spread;
        for (const Vertex v : {t.a, t.b, t.c}) spread.add(heights.at(v), heights.at(v));
        spread.add(heights.at(t.middle()), 0.5f * (heights.at(t.a) + heights.at(t.b)));
        return spread.value();
    }
    /// The samples just outside the west or the north border, over each edge that the border may have.
    void strip(const Heights& heights, bool west) {
        const auto outside = [&](int i) { return heights.at(west ? Vertex(-1, i) : Vertex(i, -1)); };
        for (int edge = 2; edge <= kSize; edge *= 2)
            for (int from = 0; from < kSize; from += edge) {
                Spread spread;
                const float a = outside(from), b = outside(from + edge);
                for (int i = 0; i <= edge; ++i)
                    spread.add(outside(from + i), a + (b - a) * static_cast<float>(i) / static_cast<float>(edge));
                const int middle = from + edge / 2;
                raise(west ? Vertex(0, middle) : Vertex(middle, 0), spread.value());
            }
    }
    Grid<float> errors_;
};

/// Collects the triangles.
class Builder {
  public:
    Builder(const Heights& heights, const SplitErrors& errors, double tolerance)
        : heights_(heights), errors_(errors), tolerance_(static_cast<float>(tolerance)) {
        refine(hierarchy()[0]);
        refine(hierarchy()[1]);
        strip(true);
        strip(false);
        // The corner between both strips.
        emit({-1, -1}, {-1, 0}, {0, -1});
        emit({0, -1}, {-1, 0}, {0, 0});
    }
    [[nodiscard]] TerrainMesh take() const {
        TerrainMesh mesh;
        for (size_t block = 0; block < blocks_.size(); ++block) {
            mesh.indices.insert(mesh.indices.end(), blocks_[block].begin(), blocks_[block].end());
            mesh.starts[block + 1] = static_cast<uint32_t>(mesh.indices.size());
        }
        return mesh;
    }

  private:
    void refine(const Triangle& t) {
        const int square = t.legSquared();
        constexpr int kWithinBlock = TerrainMesh::kBlockSide * TerrainMesh::kBlockSide;
        if (square > 1 && (square > kWithinBlock || errors_.at(t.middle()) > tolerance_)) {
            const Vertex m = t.middle();
            refine({t.c, t.a, m});
            refine({t.b, t.c, m});
            return;
        }
        emit(t.a, t.b, t.c);
        for (const Vertex v : {t.a, t.b, t.c}) {
            if (v.x == 0) west_[static_cast<size_t>(v.y)] = true;
            if (v.y == 0) north_[static_cast<size_t>(v.x)] = true;
        }
    }
    void strip(bool west) {
        const std::vector<bool>& used = west ? west_ : north_;
        int last = -1;
        for (int i = 0; i <= kSize; ++i) {
            if (!used[static_cast<size_t>(i)]) continue;
            if (last >= 0 && west) {
                emit({-1, last}, {-1, i}, {0, last});
                emit({0, last}, {-1, i}, {0, i});
            } else if (last >= 0) {
                emit({last, -1}, {last, 0}, {i, -1});
                emit({i, -1}, {last, 0}, {i, 0});
            }
            last = i;
        }
    }
    void emit(Vertex a, Vertex b, Vertex c) {
        if (std::isnan(heights_.at(a) + heights_.at(b) + heights_.at(c))) return;
        // Three times the centroid finds the block; a triangle never crosses a block's border.
        const Vertex block = glm::clamp((a + b + c) / (3 * TerrainMesh::kBlockSide), 0, TerrainMesh::kBlocksAcross - 1);
        std::vector<uint16_t>& out = blocks_[static_cast<size_t>(block.y * TerrainMesh::kBlocksAcross + block.x)];
        for (const Vertex v : {a, b, c}) {
            const Vertex local = v - block * TerrainMesh::kBlockSide + 1;
            out.push_back(static_cast<uint16_t>(local.y * TerrainMesh::kBlockStride + local.x));
        }
    }

    const Heights& heights_;
    const SplitErrors& errors_;
    float tolerance_;
    std::array<std::vector<uint16_t>, TerrainMesh::kBlocks> blocks_;
    std::vector<bool> west_ = std::vector<bool>(kSize + 1);
    std::vector<bool> north_ = std::vector<bool>(kSize + 1);
};

}  // namespace

TerrainMesh triangulated(const Grid<uint16_t>& codes, const MeshTolerance& tolerance) {
    TERRAY_CHECK_OP(codes.width(), ==, kHeightTileSide);
    TERRAY_CHECK_OP(codes.height(), ==, kHeightTileSide);
    const Heights heights(codes);
    const SplitErrors errors(heights, tolerance.sag);
    return Builder(heights, errors, tolerance.codes).take();
}

double estimatedTriangles(const Grid<uint16_t>& codes, const MeshTolerance& tolerance) {
    TERRAY_CHECK_OP(codes.width(), ==, kHeightTileSide);
    TERRAY_CHECK_OP(codes.height(), ==, kHeightTileSide);
    const Heights heights(codes);
    size_t triangles = 0;
    const auto count = [&](const Triangle& t, const auto& self) -> void {
        const double error = deviationOf(t, heights) + tolerance.sag * 2 * t.legSquared();
        if (t.legSquared() <= 1 || error <= tolerance.codes) {
            ++triangles;
            return;
        }
        self({t.c, t.a, t.middle()}, self);
        self({t.b, t.c, t.middle()}, self);
    };
    // Of the triangles with legs of 32, one in every 16, at another place of each.
    constexpr size_t kFirst = 510, kSeeds = 512, kShare = 16;
    static_assert(kFirst + 2 == kSeeds);
    for (size_t n = 0; n < kSeeds / kShare; ++n) count(hierarchy()[kFirst + kShare * n + 7 * n % kShare], count);
    // Splits that only conformity asks for are not among them.
    constexpr double kForced = 1.25;
    return kForced * kShare * static_cast<double>(triangles);
}

}  // namespace terray
