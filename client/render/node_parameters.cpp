#include "client/render/node_parameters.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace terray {
namespace {

glm::vec4 withW(const glm::dvec3& xyz, double w) {
    return glm::vec4(glm::vec3(xyz), static_cast<float>(w));
}

/// The part of an ancestor's core, in its texels, that a cell covers: corner and side. Powers of two, so exact.
struct SubSquare {
    glm::dvec2 corner{0};
    double side = kTileCore;
};

SubSquare subSquare(const TileId& cell, const TileId& ancestor) {
    const uint32_t levels = cell.level - ancestor.level;
    const double side = std::ldexp(kTileCore, -static_cast<int>(levels));
    const auto column = static_cast<double>(cell.x - (uint64_t{ancestor.x} << levels));
    const auto row = static_cast<double>(cell.y - (uint64_t{ancestor.y} << levels));
    return {{column * side, row * side}, side};
}

/// Distance from the eye to the farthest corner of a cell's box, metres.
double farthestCorner(const DrawNode& node, const Tiling& tiling, const glm::dvec3& eye) {
    const GroundRect ground = tiling.bounds(node.cell);
    const double x = std::max(std::abs(eye.x - ground.west), std::abs(eye.x - ground.east));
    const double y = std::max(std::abs(eye.y - ground.south), std::abs(eye.y - ground.north));
    const double z = std::max(std::abs(eye.z - node.minHeight), std::abs(eye.z - node.maxHeight));
    return std::hypot(x, y, z);
}

}  // namespace

interop::NodeParameters nodeParameters(const DrawNode& node, const ResidentHeights& heights, uint32_t photoSlot,
                                       const Tiling& tiling, const View& view) {
    TERRAY_CHECK(node.heightTile.covers(node.cell));
    const double spacing = tiling.spacing(node.heightTile.level);
    const double step = heights.encoding.metresPerCode();
    const GroundRect source = tiling.bounds(node.heightTile);
    const auto codeOf = [&](double height) { return height / step - static_cast<double>(heights.encoding.offset); };
    const auto tileDirection = [&](const glm::dvec3& world) {
        return glm::dvec3(world.x / spacing, -world.y / spacing, world.z / step);
    };

    interop::NodeParameters out;
    const glm::dvec3 eye((view.eye.x - source.west) / spacing, (source.north - view.eye.y) / spacing,
                         codeOf(view.eye.z));
    const double marginMetres = farthestCorner(node, tiling, view.eye) / view.focalPixels();
    out.eye = withW(eye, spacing);
    out.right = withW(tileDirection(view.right * view.tanHalfWidth()), step);
    out.up = withW(tileDirection(view.up * view.tanHalfHeight), marginMetres);
    out.forward = withW(tileDirection(view.forward), 0);

    // Half a code above and below, so that rounding the bounds to float cuts off no surface.
    const SubSquare cell = subSquare(node.cell, node.heightTile);
    out.boxMin = withW({cell.corner, codeOf(node.minHeight) - 0.5}, 0);
    out.boxMax = withW({cell.corner + cell.side, codeOf(node.maxHeight) + 0.5}, 0);

    if (node.imageryTile && photoSlot != TERRAY_NO_SLOT) {
        // Both tiles contain the cell, so one contains the other: photo texels = offset + scale * height texels.
        const SubSquare inPhoto = subSquare(node.cell, *node.imageryTile);
        const double scale = inPhoto.side / cell.side;
        out.photo = withW({inPhoto.corner - scale * cell.corner, scale}, 0);
    } else {
        out.photo = glm::vec4(0);
    }
    // Paper 001, section 3.2: start below the single block that holds the cell, for every ray enters at its box.
    const auto below = static_cast<int>(node.cell.level - node.heightTile.level);
    const auto start = static_cast<uint32_t>(std::max(8 - below, 0));
    out.source = {heights.slot, node.imageryTile ? photoSlot : TERRAY_NO_SLOT, node.cell.level, start};
    return out;
}

glm::dvec3 worldFromTile(const TileId& heightTile, const HeightEncoding& encoding, const Tiling& tiling,
                         const glm::dvec3& tilePoint) {
    const GroundRect source = tiling.bounds(heightTile);
    const double spacing = tiling.spacing(heightTile.level);
    return {source.west + tilePoint.x * spacing, source.north - tilePoint.y * spacing,
            (tilePoint.z + static_cast<double>(encoding.offset)) * encoding.metresPerCode()};
}

}  // namespace terray
