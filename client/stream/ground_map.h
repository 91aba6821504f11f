#pragma once

#include <glm/vec2.hpp>

#include "client/stream/dataset_source.h"
#include "common/grid.h"

namespace terray {

/// A small map of how high a dataset's ground may reach, for planning flights: at most about 1024 x 1024 cells over all
/// of it. Each cell is the coarse height raised by its tile's error, so no finest sample beneath lies above it.
class GroundMap {
  public:
    /// Reads a few coarse tiles. Throws Error(dataset) when one is missing or damaged.
    [[nodiscard]] static GroundMap read(const TileSource& source);

    /// The ground that has samples.
    [[nodiscard]] const GroundRect& bounds() const { return bounds_; }
    [[nodiscard]] double cellSide() const { return side_; }
    /// Lowest and highest cell; both 0 when there is no surface at all.
    [[nodiscard]] double lowest() const { return lowest_; }
    [[nodiscard]] double highest() const { return highest_; }
    /// Greatest height within a distance of a place, holes and what lies outside left out: lowest() if there is
    /// nothing.
    [[nodiscard]] double highestNear(glm::dvec2 place, double radius) const;
    /// Where the highest cell is of those at least `margin` (a share of width and height) away from the bounds' edges.
    [[nodiscard]] glm::dvec2 summit(double margin) const;
    /// Sum of the heights' changes along a line, metres: how rough the ground is there. Holes add nothing.
    [[nodiscard]] double roughness(glm::dvec2 from, glm::dvec2 to) const;

  private:
    GroundMap(const DatasetMetadata& metadata, uint32_t level);
    void take(const HeightTile& tile);
    void measure();
    [[nodiscard]] glm::dvec2 centreOf(int64_t column, int64_t row) const;

    GroundRect bounds_;
    double side_;          ///< metres of a cell
    Grid<float> heights_;  ///< metres; kNone where there is no surface
    double lowest_ = 0;
    double highest_ = 0;
};

}  // namespace terray
