#pragma once

#include <glm/vec2.hpp>

#include "client/stream/camera.h"
#include "tests/stream/fake_dataset.h"

namespace terray::test {

/// The hilly dataset that selection is tested on: 2048 x 2048 samples, levels 0..2, imagery to level 4 with a part
/// missing.
inline const FakeDataset& hillyDataset() {
    static const FakeDataset dataset = buildDataset(
        hills(300), {.imageryLevel = 4,
                     .hasPhoto = [](const TileId& id) { return id.level < 3 || id.x >= (2u << (id.level - 3)); }});
    return dataset;
}

/// Height of the finest sample at a place of the hilly dataset, as stored.
inline double groundHeight(const FakeDataset& dataset, glm::dvec2 place) {
    const Tiling& tiling = dataset.metadata.tiling;
    const auto column = static_cast<int64_t>(std::floor((place.x - tiling.west) / tiling.finestSpacing));
    const auto row = static_cast<int64_t>(std::floor((tiling.north - place.y) / tiling.finestSpacing));
    const TileId id{tiling.finestLevel, static_cast<uint32_t>(column / kTileCore),
                    static_cast<uint32_t>(row / kTileCore)};
    const HeightTile& tile = dataset.heights.at(id);
    return tile.encoding.height(tile.codes.at(column % kTileCore + kHeightApron, row % kTileCore + kHeightApron));
}

inline glm::dvec2 randomPlace(const FakeDataset& dataset, Random& random) {
    const GroundRect ground = dataset.metadata.groundBounds();
    return {random.uniform(ground.west, ground.east), random.uniform(ground.south, ground.north)};
}

/// A camera over the ground, or sometimes beside it; low or high, any direction, any field of view.
inline View randomView(const FakeDataset& dataset, Random& random) {
    const glm::dvec2 place = randomPlace(dataset, random);
    const double above = std::pow(10.0, random.uniform(0.3, 3.5));
    Camera camera{.position = {place, groundHeight(dataset, place) + above},
                  .heading = Radians(random.uniform(0, 6.28)),
                  .pitch = Radians(random.chance(0.1) ? -1.5707963267948966 : random.uniform(-1.5, 0.7)),
                  .verticalFov = radiansFromDegrees(random.uniform(5, 100))};
    if (random.chance(0.2)) camera.position.x += 3000;
    return viewOf(camera, 800, 500);
}

/// The view over flat ground, or as often over an earth so small and askew that ground drops by hundreds of metres.
inline View overSomeEarth(View view, Random& random) {
    if (random.chance(0.5)) return view;
    const double size = std::pow(10.0, random.uniform(-6, -3.7)), narrow = random.uniform(0.2, 1);
    const double turn = random.uniform(0, 3.14), c = std::cos(turn), s = std::sin(turn);
    view.earth = EarthCurvature{.xx = size * (c * c + narrow * s * s),
                                .xy = size * 2 * c * s * (1 - narrow),
                                .yy = size * (s * s + narrow * c * c)};
    return view;
}

/// A tree in which a random part of the tiles is resident, and another part known only.
inline TileTree randomTree(const FakeDataset& dataset, Random& random) {
    TileTree tree = rootsOnly(dataset);
    const double loaded = random.uniform(0.1, 1), evicted = random.uniform(0, 0.5);
    for (const auto& [id, tile] : dataset.heights) {
        const auto* known = tree.heights(id);
        if (id.level == 0 || known == nullptr || !random.chance(loaded)) continue;
        load(tree, dataset, TileLayer::heights, id);
        tree.setHeightsResident(id, !random.chance(evicted));
    }
    for (const auto& [id, tile] : dataset.imagery) {
        const auto* known = tree.imagery(id);
        if (id.level == 0 || known == nullptr || !random.chance(loaded)) continue;
        load(tree, dataset, TileLayer::imagery, id);
        tree.setImageryResident(id, !random.chance(evicted));
    }
    return tree;
}

}  // namespace terray::test
