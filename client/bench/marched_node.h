#pragma once

#include <array>

#include <glm/vec3.hpp>

#include "client/render/terrain_renderer.h"
#include "common/draw_node.h"
#include "common/grid.h"
#include "common/height_tile.h"
#include "common/view.h"

namespace terray {

/// A decoded height tile with its maximum mipmap, as GpuTiles holds it.
struct MarchedTile {
    explicit MarchedTile(HeightTile decoded);

    /// Greatest code in and around a block of core cells, kNoSurface where they have none; level 0: the cell's own.
    [[nodiscard]] uint16_t blockMaximum(int64_t x, int64_t y, int level) const {
        if (level == 0) return codeAt(x, y);
        return maxima[static_cast<size_t>(level)].at(x, y);
    }
    /// Of a core cell or of one of the apron.
    [[nodiscard]] uint16_t codeAt(int64_t x, int64_t y) const {
        return stored.codes.at(x + kHeightApron, y + kHeightApron);
    }

    HeightTile stored;
    std::array<Grid<uint16_t>, 10> maxima;  ///< of levels 1 .. 9, at [level]; level 0 is the codes
};

/// A draw node as nodeParameters() tells it to the shaders, before anything is rounded to float. Tile frame.
struct MarchedNode {
    MarchedNode(const DrawNode& node, const MarchedTile& tile, const Tiling& tiling, const View& view, Surface surface);

    const MarchedTile* tile;
    glm::dvec3 eye;
    glm::dvec3 right;  ///< half the picture's width at view depth 1 m; up: half its height
    glm::dvec3 up;
    glm::dvec3 forward;  ///< 1 m
    glm::dvec3 boxMin;
    glm::dvec3 boxMax;
    double spacing;  ///< metres per texel
    double step;     ///< metres per code, exaggerated
    glm::dvec3 bend{0};
    bool curved;
    bool bilinear;
    int startLevel;
};

}  // namespace terray
