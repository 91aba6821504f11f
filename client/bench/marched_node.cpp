#include "client/bench/marched_node.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "client/render/node_parameters.h"

namespace terray {
namespace {

/// Level 1 over the codes: blocks of 2 x 2 core cells with the ring around them.
Grid<uint16_t> firstMaxima(const HeightTile& tile) {
    Grid<uint16_t> maxima({kTileCore / 2, kTileCore / 2}, kNoSurface);
    for (int64_t y = 0; y < maxima.height(); ++y)
        for (int64_t x = 0; x < maxima.width(); ++x)
            for (int64_t row = -1; row < 3; ++row)
                for (int64_t column = -1; column < 3; ++column)
                    maxima.at(x, y) = std::max(
                        maxima.at(x, y), tile.codes.at(2 * x + column + kHeightApron, 2 * y + row + kHeightApron));
    return maxima;
}

/// Four blocks with their rings make one with its ring.
Grid<uint16_t> coarser(const Grid<uint16_t>& finer) {
    Grid<uint16_t> maxima({finer.width() / 2, finer.height() / 2}, kNoSurface);
    for (int64_t y = 0; y < finer.height(); ++y)
        for (int64_t x = 0; x < finer.width(); ++x)
            maxima.at(x / 2, y / 2) = std::max(maxima.at(x / 2, y / 2), finer.at(x, y));
    return maxima;
}

}  // namespace

MarchedTile::MarchedTile(HeightTile decoded) : stored(std::move(decoded)) {
    maxima[1] = firstMaxima(stored);
    for (size_t level = 2; level < maxima.size(); ++level) maxima[level] = coarser(maxima[level - 1]);
}

MarchedNode::MarchedNode(const DrawNode& node, const MarchedTile& of, const Tiling& tiling, const View& view,
                         Surface surface)
    : tile(&of),
      spacing(tiling.spacing(node.heightTile.level)),
      step(view.exaggeration * of.stored.encoding.metresPerCode()),
      curved(view.earth.has_value()),
      bilinear(surface == Surface::bilinear || (surface == Surface::automatic && magnified(node, tiling, view))) {
    const HeightEncoding& encoding = of.stored.encoding;
    const auto code = [&](double height) {
        return height / encoding.metresPerCode() - static_cast<double>(encoding.offset);
    };
    const auto direction = [&](const glm::dvec3& world) {
        return glm::dvec3(world.x / spacing, -world.y / spacing, world.z / step);
    };
    eye = glm::dvec3(eyeInTile(node.heightTile, tiling, view.eye), code(view.eye.z / view.exaggeration));
    right = direction(view.right * view.tanHalfWidth());
    up = direction(view.up * view.tanHalfHeight);
    forward = direction(view.forward);
    // The cell within its height tile, with room above and below, as in nodeParameters(). For patches the
    // tile's greatest code in place of the greatest of this part: rays enter a little higher, and hit the same.
    const auto below = static_cast<int>(node.cell.level - node.heightTile.level);
    const double west = std::ldexp(static_cast<double>(node.cell.x), -below) - node.heightTile.x;
    const double north = std::ldexp(static_cast<double>(node.cell.y), -below) - node.heightTile.y;
    const double side = std::ldexp(kTileCore, -below);
    const double margin = boxMargin(node, tiling, view, eye.z, step);
    const double top = bilinear ? of.maxima[9].at(0, 0) : code(node.maxHeight);
    boxMin = {kTileCore * west, kTileCore * north, code(node.minHeight) - margin};
    boxMax = {kTileCore * west + side, kTileCore * north + side, top + margin};
    if (view.earth) bend = {view.earth->xx, view.earth->xy, view.earth->yy};
    startLevel = std::max(8 - below, bilinear ? 1 : 0);
}

}  // namespace terray
