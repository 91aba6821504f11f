#pragma once

#include <span>

#include "common/terrain_edit.h"

// What edits can do to heights over a rectangle: bounds, derived from the closed forms of common/terrain_edit.h.

namespace terray {

/// The heights from lowest to highest, metres.
struct HeightSpan {
    double lowest = 0;
    double highest = 0;
    bool operator==(const HeightSpan&) const = default;
};

/// Bounds of what a list of edits does over a rectangle.
struct EditBounds {
    /// Heights that were within `before`, after the edits and after each part of the list: so it holds `before` too.
    HeightSpan heights;
    /// How far the result for one height, out of `before`, may differ between two places of the rectangle that lie no
    /// farther apart than asked.
    double variation = 0;
};

/// Each edit k takes the span [lo, hi] to itself widened by the least and greatest change that its profile has over the
/// distances from its line that occur in the rectangle; a level, to its hull with (1 - w) lo + w height and
/// (1 - w) hi + w height for the greatest w. Since an edit keeps the order of heights, these are bounds.
///
/// Variation: between two places at most `apart` metres from one another, edit k changes its result for a height by at
/// most min(slope_k apart, spread_k): the distance to a line changes by no more than the place does, slope_k is the
/// steepest slope of its profile over the rectangle's distances (for a level, times the greatest |height - h| of the
/// span so far), and spread_k is the difference between its greatest and its least change there. As no edit takes two
/// heights farther apart, these add up over the list.
///
/// @param edits  editsNear() of the rectangle, or more  @param rect  convex, so it holds the way from place to place
[[nodiscard]] EditBounds editBounds(std::span<const TerrainEdit> edits, const GroundRect& rect,
                                    const HeightSpan& before, double apart);

}  // namespace terray
