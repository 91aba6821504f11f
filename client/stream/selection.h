#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "client/stream/dataset_source.h"
#include "client/stream/tile_tree.h"
#include "common/draw_node.h"
#include "common/units.h"
#include "common/view.h"

namespace terray {

// The algorithm in words.
//
// Cells of the quadtree are visited from the root in pre-order, the children of a cell in the order in which rays from
// the eye meet them (the quadrant on the eye's side first, the opposite one last), so the draw list comes out front to
// back. A cell outside the view frustum is skipped. A cell asks to be split while its height tile's geometric error, or
// a texel of its photo, is larger on the screen than the tolerance and a finer tile exists. Heights and photo ask
// independently: a cell may go on splitting for its photo while its heights stay those of an ancestor.
//
// A finer tile that is wanted but not resident is put on the wanted list; meanwhile the nearest resident ancestor
// stands in for it with a sub-rectangle, or its children do where all of them are resident, as after the camera has
// moved away. When none of the four children has anything finer to show, the cell is not
// split. A child whose record says that it has no surface is not drawn: there is nothing there.
//
// The box of a cell reaches down to the lowest finest sample that may lie in it or in the eight squares of its size
// around it: no surface that a neighbour may show, whatever tile it is drawn from, lies lower, so the cell's walls
// close every level jump. Culling uses these boxes too, for a wall may be all of a cell that the picture sees. (Not the
// neighbours' errors in place of their bounds: a coarse tile's apron is a mean, and hides a pit that a finer neighbour
// shows.)
//
// Over a curved earth (View::earth) frustum and distances are asked about boxes lowered by the drop, as they are seen.
// Seen from above, rays still run straight, so the order of nodes is the same; and walls are about heights at one
// place, so they reach as deep. A projected error is the same ratio of error to distance.
//
// Exaggerated (View::exaggeration), boxes and errors are multiplied when frustum and distances are asked; what the tree
// knows, and what draw nodes say, stays in heights.
//
// With shadows, cells outside the picture whose shadow may fall into it are selected too, as casters, by the same
// criteria of detail as what is seen: a shadow's edge fits what it falls on. Their tiles are asked for at half urgency.

/// What tolerances were multiplied by to keep the limits; 1: nothing was given up.
struct Coarsening {
    double heights = 1;
    double imagery = 1;
    bool operator==(const Coarsening&) const = default;
};

struct SelectionOptions {
    Pixels tolerance{2.0 / 3.0};  ///< of the projected geometric error (paper 001, section 4)
    /// Heights by distance alone, in place of the tolerance (paper 000, section 3.5, tile by tile): the finest as far
    /// as so many of their samples from the eye, in three dimensions, and half as fine over each doubling of the
    /// distance.
    std::optional<double> lodDistance;
    Pixels imageryTolerance{1.0};  ///< of the projected side of a photo texel
    bool useImagery = true;
    /// Towards the sun, unit length, z > 0, when shadows are drawn.
    std::optional<glm::dvec3> shadowsFrom;
    // Limits. Where one would be exceeded, tolerances are multiplied by the least factor (to 10 %) that keeps it, so
    // that near and far give up detail alike.
    size_t maxNodes = 4096;                                       ///< of the draw list
    size_t maxHeightTiles = std::numeric_limits<size_t>::max();   ///< of Selection::heightTiles
    size_t maxImageryTiles = std::numeric_limits<size_t>::max();  ///< of Selection::imageryTiles
    /// Tolerances are multiplied by no less than this: parts of a picture give up what one of them must.
    Coarsening leastCoarsening;
};

/// A tile to load: wanted for this view and not resident.
struct TileRequest {
    TileLayer layer = TileLayer::heights;
    TileId id;
    double priority = 0;  ///< projected error in pixels that its absence costs; greater is more urgent
    bool operator==(const TileRequest&) const = default;
};

struct Selection {
    std::vector<DrawNode> nodes;      ///< front to back
    std::vector<DrawNode> casters;    ///< outside the picture, casting shadows into it; no imagery; in no useful order
    std::vector<TileRequest> wanted;  ///< most urgent first; ties in a fixed order
    /// The tiles that the view needs, resident or wanted, but for the roots: once all are resident, all is exact.
    std::vector<TileId> heightTiles;
    std::vector<TileId> imageryTiles;
    Coarsening coarsening;
    [[nodiscard]] bool limited() const { return coarsening != Coarsening(); }
    [[nodiscard]] bool complete() const { return wanted.empty(); }
};

/// Size on screen of a tile's geometric error.
///
/// @param error     how far the tile's surface may lie from the finest data, >= 0
/// @param distance  from the eye to the nearest point of the tile's bounds; below 1 mm counts as 1 mm
/// @return          pixels, exact on the image axis. At angle t off the axis the true size is up to
///                  1/cos(t)^2 larger (1.57 at 37 degrees), since |grad(f x/z)| = f / (d cos(t)^2).
[[nodiscard]] Pixels screenError(Metres error, Metres distance, const View& view);

/// A pure function: same tree, view and options, same answer. The root tiles must be resident.
[[nodiscard]] Selection select(const TileTree& tree, const View& view, const SelectionOptions& options);

/// Puts nodes whose cells do not overlap in the order in which rays from an eye meet them: a list that was selected for
/// one eye can then be drawn from another.
void sortFrontToBack(std::vector<DrawNode>& nodes, const Tiling& tiling, const glm::dvec3& eye);

}  // namespace terray
