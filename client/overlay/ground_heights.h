#pragma once

#include <optional>
#include <utility>

#include <glm/vec2.hpp>

#include "client/stream/dataset_source.h"
#include "common/terrain_edit.h"

namespace terray {

/// Heights of a dataset's finest samples, edited, at single places. Reads tiles from the root down to the place's own,
/// and keeps the last of them, so that places near one another cost one reading. One thread at a time.
class GroundHeights {
  public:
    /// @param source  outlives this object  @param edits  of the ground
    explicit GroundHeights(const TileSource& source, EditList edits = {}) : source_(source), edits_(std::move(edits)) {}

    /// Height of the sample whose cell holds the place, metres: the top of its column, edited at the sample's centre as
    /// the GPU does it (EditedGround). None where there is no surface.
    /// Throws Error(dataset) when a tile cannot be read.
    [[nodiscard]] std::optional<double> at(glm::dvec2 place);
    /// No sample of the dataset, as it is stored, lies lower; metres.
    [[nodiscard]] double lowest() const { return source_.metadata().minHeight; }

  private:
    [[nodiscard]] HeightTile read(const TileId& id) const;
    /// The deepest tile over a place; none beyond the surface.
    [[nodiscard]] bool find(glm::dvec2 place);

    const TileSource& source_;
    EditList edits_;
    std::optional<HeightTile> tile_;
};

}  // namespace terray
