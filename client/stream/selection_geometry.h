#pragma once

#include <array>
#include <limits>

#include <glm/vec3.hpp>

#include "client/stream/tile_tree.h"
#include "common/tiling.h"
#include "common/units.h"
#include "common/view.h"

// What selection asks of geometry: boxes, the frustum, and how high the ground may be. World frame, metres.

namespace terray {

struct HeightRange {
    double min = 0;
    double max = 0;
};

/// An axis-parallel box.
struct Box {
    glm::dvec3 min{0};
    glm::dvec3 max{0};
};

/// The box over a cell's square.
[[nodiscard]] Box boxOf(const TileId& cell, const HeightRange& heights, const Tiling& tiling);
/// The same as straight lines of sight meet it: exaggerated, and over a curved earth lowered, its top by the least drop
/// and its bottom by the greatest, so that it holds every lowered point of the cell.
[[nodiscard]] Box seenBoxOf(const TileId& cell, const HeightRange& heights, const Tiling& tiling, const View& view);
/// From a point to the nearest point of a box; 0 inside.
[[nodiscard]] Metres distanceTo(const Box& box, const glm::dvec3& point);

/// What a picture, or its part, sees: the side planes through the eye and the plane through the eye across the view
/// axis.
class Frustum {
  public:
    explicit Frustum(const View& view);
    /// Never false for a box that the straight ray of some point of the picture meets; now and then true for one
    /// outside.
    [[nodiscard]] bool mayMeet(const Box& box) const;
    /// The same of a box's shadow: all places up to `length` metres from the box along `away`, unit length.
    [[nodiscard]] bool mayMeetShadow(const Box& box, const glm::dvec3& away, double length) const;

  private:
    glm::dvec3 eye_;
    std::array<glm::dvec3, 5> inward_;  ///< normals
};

/// What is known of the ground under one square, from its own record or the deepest known one above it.
struct Ground {
    bool surface = false;   ///< false: nothing there, or beyond the root square
    bool hasHoles = false;  ///< at the record's level, apron included
    /// Bounds of the finest samples: the record's heights less and plus its error.
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    double bottom = -std::numeric_limits<double>::infinity();  ///< the record's least height
    double top = std::numeric_limits<double>::infinity();      ///< the record's greatest height
};

/// A cell and the eight of its size around it, rows from the north: itself is number 4.
using Neighbourhood = std::array<Ground, 9>;

/// Bounds of the ground, carried down from the root with the traversal, nine look-ups per cell.
///
/// They hold for every surface that may be drawn, exact or stand-in: a coarser sample is a mean of finest ones, so it
/// lies between their extremes, but for the rounding of codes, which a margin covers. (A stand-in's samples must be no
/// larger than the cell.)
class GroundBounds {
  public:
    /// The root must have been learnt.
    explicit GroundBounds(const TileTree& tree);

    [[nodiscard]] Neighbourhood ofRoot() const;
    /// @param deepest  records of deeper levels are not used
    [[nodiscard]] Neighbourhood ofChild(const Neighbourhood& parent, const TileId& child, uint32_t deepest) const;

    /// How far down a cell's walls must reach so that no neighbour's surface lies below them, whatever tile the
    /// neighbour is drawn from: to the lowest finest sample that may lie in the nine squares. Where there are holes,
    /// and at the edge of the ground, down to one floor for the whole dataset: the ground is a solid block.
    [[nodiscard]] double wallFoot(const Neighbourhood& cell) const;
    /// How high any surface that may be drawn in a cell may reach, its finest samples too.
    /// @param levelsAbove  of the tiles that may be drawn: 0 its own, 1 its parent, ... Between samples a surface leans
    ///                     on those beside the cell. One level up, they are means of what the cell's own apron holds;
    ///                     farther up, of what the squares around it hold.
    [[nodiscard]] double highest(const Neighbourhood& cell, uint32_t levelsAbove) const;
    /// How high a surface in the cell may reach that is drawn from a tile `levelsAbove` it.
    [[nodiscard]] double top(const Neighbourhood& cell, uint32_t levelsAbove) const;

  private:
    [[nodiscard]] double highestAround(const Neighbourhood& cell) const;

    const TileTree& tree_;
    double margin_;  ///< metres: what rounding to codes may add up to over the levels
    double floor_;   ///< metres
};

}  // namespace terray
