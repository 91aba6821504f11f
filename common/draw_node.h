#pragma once

#include <optional>

#include "common/tile_id.h"

namespace terray {

/// One piece of ground to draw: the plain value in which selection (client/stream) and renderer (client/render) meet.
///
/// The cell is a square of the quadtree. Its heights come from the tile of that id or, where that is not loaded or not
/// needed, from an ancestor's sub-rectangle; its photo likewise, independently. A list of draw nodes is ordered front
/// to back as seen from the eye, its cells do not overlap, and every tile it names is resident.
struct DrawNode {
    TileId cell;
    TileId heightTile;                  ///< covers cell
    std::optional<TileId> imageryTile;  ///< covers cell; none: neutral ground
    /// Heights of the box that is rasterised, metres, not exaggerated. maxHeight bounds the drawn surface from above. minHeight reaches below every
    /// surface that a neighbouring node may show along the shared border, so that walls close level jumps (design: the
    /// ground is solid). It does not bound how deep the solid goes.
    double minHeight = 0;
    double maxHeight = 0;
    double screenError = 0;    ///< pixels: projected geometric error of the height source
    bool heightsExact = true;  ///< false: an ancestor stands in because the wanted tile is not resident
    bool imageryExact = true;
};

}  // namespace terray
