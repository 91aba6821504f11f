#pragma once

#include "client/render/gpu_tiles.h"
#include "common/draw_node.h"
#include "common/tiling.h"
#include "common/view.h"
#include "shaders/interop.h"

namespace terray {

/// A node as the shaders see it: eye, view axes and box in the tile frame of its height source (see shaders/interop.h).
///
/// All differences are taken in double; what is rounded to float is relative to the tile. A ray's position is then off
/// by at most a few last places of the eye's distance in texels, 2^-22 of it: far below a pixel, which is about 2^-10
/// of it.
/// @param photoSlot  layer of the node's imagery tile, or TERRAY_NO_SLOT
[[nodiscard]] interop::NodeParameters nodeParameters(const DrawNode& node, const ResidentHeights& heights,
                                                     uint32_t photoSlot, const Tiling& tiling, const View& view);

/// World position (metres) of a point of a height tile's frame, in double.
[[nodiscard]] glm::dvec3 worldFromTile(const TileId& heightTile, const HeightEncoding& encoding, const Tiling& tiling,
                                       const glm::dvec3& tilePoint);

}  // namespace terray
