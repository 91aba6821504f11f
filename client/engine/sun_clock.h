#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "common/dataset_metadata.h"
#include "common/projection.h"
#include "common/utc_time.h"

namespace terray {

/// The sun of one moment over the places of a dataset.
class SunClock {
  public:
    /// Throws Error(georeference) when nothing says where on the earth the dataset lies, Error(unsupported) when this
    /// build has no PROJ to find it out.
    SunClock(UtcTime time, const DatasetMetadata& metadata);

    /// Unit vector towards the sun, world frame, over a place in the dataset's coordinates; see gridSunDirection().
    /// Throws Error(georeference) where the dataset's projection has no place on the earth.
    [[nodiscard]] glm::dvec3 direction(glm::dvec2 place) const;

  private:
    UtcTime time_;
    Projection projection_;
};

}  // namespace terray
