#pragma once

#include "client/render/gpu_tiles.h"
#include "common/draw_node.h"
#include "common/tiling.h"
#include "common/view.h"
#include "shaders/interop.h"

namespace terray {

/// What a node is drawn from.
struct NodeSource {
    const ResidentHeights& heights;
    uint32_t photoSlot = TERRAY_NO_SLOT;  ///< layer of the node's imagery tile
    bool bilinear = false;                ///< the surface: patches between sample centres, or columns
    bool pyramid = true;                  ///< off: every ray walks from sample to sample
    bool castsShadow = false;             ///< shadow rays see patches whatever the surface: the box bounds them too
};

/// A node as the shaders see it: eye, view axes and box in the tile frame of its height source (see shaders/interop.h).
///
/// All differences are taken in double; what is rounded to float is relative to the tile. A ray's position is then off
/// by at most a few last places of the eye's distance in texels, 2^-22 of it: far below a pixel, which is about 2^-10
/// of it.
[[nodiscard]] interop::NodeParameters nodeParameters(const DrawNode& node, const NodeSource& source,
                                                     const Tiling& tiling, const View& view);

/// The eye in a height tile's frame, x and y in texels. Counted from the root square's corner, so that the frames of
/// all tiles agree to the last place about a ray between two of them.
[[nodiscard]] glm::dvec2 eyeInTile(const TileId& heightTile, const Tiling& tiling, const glm::dvec3& eye);

/// The same on a grid of 2^-15 texels, which floats hold at any place of a tile: to them, too, the frames of a level
/// agree. (Else a ray along a border of two tiles may be rounded out of the one and not into the other.)
[[nodiscard]] glm::dvec2 onFloatGrid(const glm::dvec2& eye);

/// Codes by which a node's box is higher and lower than what it holds: half a one, so that rounding its bounds to float
/// cuts off no surface, and 2^-20 of what a ray's height at the box is the sum of, some 16 roundings of it. Seen from
/// 10^7 codes above, both ends of a box of flat ground would else be the same, and the ray through it empty.
/// @param eyeCode  the eye's height above the tile's code 0  @param step  metres per code, exaggerated
[[nodiscard]] double boxMargin(const DrawNode& node, const Tiling& tiling, const View& view, double eyeCode,
                               double step);

/// Whether a sample of the node's height tile may cover more than a pixel at the node's nearest point: there columns
/// would show as steps, and the surface is drawn bilinear.
[[nodiscard]] bool magnified(const DrawNode& node, const Tiling& tiling, const View& view);

/// The pixels that a node's box covers as it is seen (over a curved earth, lowered), as least x, least y, greatest x,
/// greatest y, counted like gl_FragCoord (of the part that is drawn; y from the bottom, centres at + 0.5), widened by
/// one pixel; least > greatest when the box lies behind the eye. Conservative: every pixel whose ray meets the box lies
/// inside, though most boxes cover only part of it.
[[nodiscard]] glm::vec4 pixelBounds(const interop::NodeParameters& node, const View& view);

/// How many pixels of the picture a node's box covers as it is seen: the area of its outline within the picture.
[[nodiscard]] double coveredPixels(const interop::NodeParameters& node, const View& view);

/// Place (metres, z a height, not exaggerated) of a point of a height tile's frame, in double.
[[nodiscard]] glm::dvec3 worldFromTile(const TileId& heightTile, const HeightEncoding& encoding, const Tiling& tiling,
                                       const glm::dvec3& tilePoint);

}  // namespace terray
