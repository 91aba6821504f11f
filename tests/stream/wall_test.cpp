// Level jumps are closed: boxes reach below their neighbours' surfaces, and no ray passes through the ground.

#include <algorithm>
#include <cmath>
#include <optional>

#include <glm/common.hpp>
#include <glm/ext/vector_int2_sized.hpp>
#include <gtest/gtest.h>

#include "client/stream/selection.h"
#include "tests/stream/views.h"

namespace terray::test {
namespace {

/// The hilly dataset without the flags by which cells at its edge reach down to the floor: then bounds alone must do.
const FakeDataset& unflaggedDataset() {
    static const FakeDataset dataset = [] {
        FakeDataset copy = hillyDataset();
        for (auto& [id, tile] : copy.heights) {
            tile.record.hasHoles = false;
            for (HeightRecord& child : tile.children) child.hasHoles = false;
        }
        return copy;
    }();
    return dataset;
}

/// Surface that a node shows at a place of its (closed) square: the column of its height tile there.
/// @param inward  which column, when the place lies between two: the one towards this side
std::optional<double> shownHeight(const FakeDataset& dataset, const DrawNode& node, glm::dvec2 place,
                                  glm::dvec2 inward) {
    const Tiling& tiling = dataset.metadata.tiling;
    const HeightTile& tile = dataset.heights.at(node.heightTile);
    const GroundRect square = tiling.bounds(node.heightTile);
    const double spacing = tiling.spacing(node.heightTile.level);
    const glm::dvec2 inside = place + 1e-3 * tiling.finestSpacing * inward;
    const auto column = static_cast<int64_t>(std::floor((inside.x - square.west) / spacing));
    const auto row = static_cast<int64_t>(std::floor((square.north - inside.y) / spacing));
    const uint16_t code = tile.codes.at(column + kHeightApron, row + kHeightApron);
    if (code == kNoSurface) return {};
    return tile.encoding.height(code);
}

bool contains(const GroundRect& square, glm::dvec2 place) {
    return place.x >= square.west && place.x <= square.east && place.y >= square.south && place.y <= square.north;
}

TEST(Walls, ReachBelowWhateverANeighbourShowsAtTheSharedBorder) {
    const FakeDataset& dataset = unflaggedDataset();
    const Tiling& tiling = dataset.metadata.tiling;
    Random random(4);
    int checked = 0;
    for (int round = 0; round < 60; ++round) {
        const TileTree tree = randomTree(dataset, random);
        const auto nodes = select(tree, randomView(dataset, random), {}).nodes;
        for (const DrawNode& node : nodes) {
            const GroundRect square = tiling.bounds(node.cell);
            for (double along = 0.25; along < square.east - square.west; along += 1) {
                const glm::dvec2 borders[] = {{square.west, square.south + along},
                                              {square.east, square.south + along},
                                              {square.west + along, square.south},
                                              {square.west + along, square.north}};
                const glm::dvec2 outward[] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
                for (int side = 0; side < 4; ++side) {
                    for (const DrawNode& other : nodes) {
                        if (other.cell == node.cell || !contains(tiling.bounds(other.cell), borders[side])) continue;
                        const auto shown = shownHeight(dataset, other, borders[side], outward[side]);
                        ++checked;
                        ASSERT_LT(node.minHeight, shown.value_or(1e9)) << node.cell << " beside " << other.cell;
                    }
                }
                along += node.cell.level < 3 ? 6 : 0;  // every column of small cells, some of large ones
            }
        }
    }
    EXPECT_GT(checked, 10000);
}

TEST(Walls, BoxesHoldTheSurfaceThatIsDrawn) {
    const FakeDataset& dataset = unflaggedDataset();
    const Tiling& tiling = dataset.metadata.tiling;
    Random random(5);
    for (int round = 0; round < 100; ++round) {
        const TileTree tree = randomTree(dataset, random);
        for (const DrawNode& node : select(tree, randomView(dataset, random), {}).nodes) {
            const GroundRect square = tiling.bounds(node.cell);
            for (int sample = 0; sample < 50; ++sample) {
                const glm::dvec2 place(random.uniform(square.west, square.east),
                                       random.uniform(square.south, square.north));
                const auto height = shownHeight(dataset, node, place, {0, 0});
                ASSERT_TRUE(height.has_value());
                ASSERT_LT(node.minHeight, *height);
                ASSERT_GE(node.maxHeight + 1e-9, *height);
            }
        }
    }
}

/// The bilinear surface of a node's height tile at a place, between the centres of its samples.
double bilinearHeight(const FakeDataset& dataset, const DrawNode& node, glm::dvec2 place) {
    const Tiling& tiling = dataset.metadata.tiling;
    const HeightTile& tile = dataset.heights.at(node.heightTile);
    const GroundRect square = tiling.bounds(node.heightTile);
    const double spacing = tiling.spacing(node.heightTile.level);
    const double x = (place.x - square.west) / spacing - 0.5, y = (square.north - place.y) / spacing - 0.5;
    double height = 0;
    for (const double column : {std::floor(x), std::floor(x) + 1})
        for (const double row : {std::floor(y), std::floor(y) + 1}) {
            const auto cell = glm::i64vec2(column, row) + int64_t{kHeightApron};
            const double weight = (1 - std::abs(x - column)) * (1 - std::abs(y - row));
            height += weight * tile.encoding.height(tile.codes.at(cell.x, cell.y));
        }
    return height;
}

TEST(Walls, BoxesHoldTheBilinearSurfaceThoughItLeansOnSamplesBesideTheCell) {
    // Walls of one and two samples beside the borders of tiles: in the mean of a coarse sample across the border, but
    // not in the apron of the finest tile before it.
    const HeightFormula walls = [](int64_t column, int64_t row) {
        const int64_t x = column % 1024, y = row % 1024;
        return x == 514 || x == 515 || y == 1020 ? 900.0 : static_cast<double>((column * 7 + row * 3) % 11);
    };
    FakeDataset dataset = buildDataset(walls, {});
    for (auto& [id, tile] : dataset.heights) {
        tile.record.hasHoles = false;  // of the edge: samples beyond it are as the last ones
        for (HeightRecord& child : tile.children) child.hasHoles = false;
    }
    const Tiling& tiling = dataset.metadata.tiling;
    Random random(6);
    int standIns = 0;
    for (int round = 0; round < 200; ++round) {
        const TileTree tree = randomTree(dataset, random);
        for (const DrawNode& node : select(tree, randomView(dataset, random), {}).nodes) {
            const GroundRect square = tiling.bounds(node.cell), ground = dataset.metadata.groundBounds();
            const double edge = tiling.spacing(node.heightTile.level);
            if (node.cell.level > node.heightTile.level + 1) ++standIns;
            for (int sample = 0; sample < 100; ++sample) {
                // Near the cell's sides, but not so near the ground's that a sample is missing.
                const auto near = [&](double low, double high) {
                    const double in = random.uniform(0, edge);
                    return random.chance(0.5) ? low + in : high - in;
                };
                const glm::dvec2 place(near(square.west, square.east), near(square.south, square.north));
                if (place.x < ground.west + edge || place.x > ground.east - edge || place.y < ground.south + edge ||
                    place.y > ground.north - edge)
                    continue;
                const double height = bilinearHeight(dataset, node, place);
                ASSERT_LT(node.minHeight, height);
                ASSERT_GE(node.maxHeight + 1e-9, height) << node.cell << " from " << node.heightTile;
            }
        }
    }
    EXPECT_GT(standIns, 50) << "of two levels and more";
}

/// Least and greatest height of a ray over an interval: a parabola's least may lie between the ends.
std::pair<double, double> heightsBetween(const View& view, const glm::dvec3& ray, double t0, double t1) {
    const double a = view.at(ray, t0).z, b = view.at(ray, t1).z;
    const double bend = view.earth ? view.earth->drop(ray.x, ray.y) : 0;
    const double vertex = bend > 0 ? std::clamp(-ray.z / (2 * bend), t0, t1) : t0;
    return {std::min({a, b, view.at(ray, vertex).z}), std::max(a, b)};
}

/// Whether a ray hits a node's solid columns, walking them one by one: the renderer's task, done plainly.
bool hits(const FakeDataset& dataset, const DrawNode& node, const View& view, glm::dvec3 ray) {
    const Tiling& tiling = dataset.metadata.tiling;
    const GroundRect cell = tiling.bounds(node.cell);
    double enter = 0, leave = 1e9;
    const auto cut = [&](double eye, double direction, double low, double high) {
        const double a = (low - eye) / direction, b = (high - eye) / direction;
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    };
    cut(view.eye.x, ray.x, cell.west, cell.east);
    cut(view.eye.y, ray.y, cell.south, cell.north);
    const double spacing = tiling.spacing(node.heightTile.level);
    for (double t = enter; t < leave;) {
        // The next column border along either axis.
        double next = leave;
        for (int axis = 0; axis < 2; ++axis) {
            const double origin = axis == 0 ? tiling.west : tiling.north;
            const double steps = (view.eye[axis] + (t + 1e-9) * ray[axis] - origin) / spacing;
            const double border = origin + (ray[axis] > 0 ? std::floor(steps) + 1 : std::ceil(steps) - 1) * spacing;
            next = std::min(next, (border - view.eye[axis]) / ray[axis]);
        }
        next = std::max(next, t + 1e-7);
        const glm::dvec3 middle = view.eye + (t + next) / 2 * ray;
        const glm::dvec2 inside = glm::clamp(glm::dvec2(middle), glm::dvec2(cell.west, cell.south) + 1e-6,
                                             glm::dvec2(cell.east, cell.north) - 1e-6);
        const auto height = shownHeight(dataset, node, inside, {0, 0});
        const auto [lowest, highest] = heightsBetween(view, ray, t, std::min(next, leave));
        if (height && lowest <= *height && highest >= node.minHeight) return true;
        t = next;
    }
    return false;
}

TEST(Walls, NoRayThatEntersTheGroundPassesThroughIt) {
    const FakeDataset& dataset = unflaggedDataset();
    const GroundRect ground = dataset.metadata.groundBounds();
    const double low = dataset.metadata.minHeight;
    Random random(6);
    int rays = 0, bent = 0;
    for (int round = 0; round < 2000; ++round) {
        const TileTree tree = randomTree(dataset, random);
        const View view = overSomeEarth(randomView(dataset, random), random);
        const auto nodes = select(tree, view, {}).nodes;
        for (int sample = 0; sample < 40; ++sample) {
            const glm::dvec3 ray = view.direction(random.uniform(0, view.width), random.uniform(0, view.height));
            // It must hit if it is inside the ground's outline where it is as low as the lowest sample.
            if (ray.z >= 0) continue;
            const double bend = view.earth ? view.earth->drop(ray.x, ray.y) : 0;
            const double root = ray.z * ray.z - 4 * bend * (view.eye.z - low);
            if (root < 0) continue;  // over the horizon
            const glm::dvec3 bottom = view.at(ray, 2 * (view.eye.z - low) / (std::sqrt(root) - ray.z));
            if (!contains(ground, glm::dvec2(bottom))) continue;
            ++rays;
            bent += view.earth ? 1 : 0;
            const bool hit = std::any_of(nodes.begin(), nodes.end(),
                                         [&](const DrawNode& node) { return hits(dataset, node, view, ray); });
            ASSERT_TRUE(hit) << "round " << round << " sample " << sample;
        }
    }
    EXPECT_GT(rays - bent, 3000);
    EXPECT_GT(bent, 1000);
}

TEST(Walls, AtTheEdgeAndAtHolesReachOneFloor) {
    const FakeDataset dataset = buildDataset(
        [](int64_t x, int64_t y) { return x > 700 && y > 700 && x < 720 ? NAN : 50 + static_cast<double>(x % 7); },
        {.samples = {1024, 1024}});
    const TileTree tree = everything(dataset);
    const View view =
        viewOf({.position = {1500, 4500, 500}, .heading = {}, .pitch = Radians(-1.5707963267948966)}, 1000, 1000);
    const auto nodes = select(tree, view, {.tolerance = Pixels(1e-6)}).nodes;
    ASSERT_EQ(nodes.size(), 4u);
    for (const DrawNode& node : nodes) EXPECT_EQ(node.minHeight, nodes[0].minHeight) << node.cell;
    EXPECT_LT(nodes[0].minHeight, dataset.metadata.minHeight);
}

}  // namespace
}  // namespace terray::test
