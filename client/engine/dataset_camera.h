#pragma once

#include <optional>

#include "client/engine/earth.h"
#include "client/stream/camera.h"
#include "common/dataset_metadata.h"
#include "common/projection.h"

namespace terray {

/// The projection of a dataset; none for a plain image without a coordinate system, and none in a build without PROJ:
/// cameras are then given in the dataset's own x and y. Throws Error(georeference) when PROJ cannot use the dataset's
/// coordinate system.
[[nodiscard]] std::optional<Projection> projectionOf(const DatasetMetadata& metadata);

/// A camera that has the whole dataset in its picture: from the south, looking north and 40 degrees down, every corner
/// of the box around ground and heights, as it is seen, within the middle nine tenths of the picture.
/// @param aspect  width of the picture by its height  @param exaggeration  that the picture is drawn with
[[nodiscard]] Camera overviewCamera(const DatasetMetadata& metadata, double aspect, const EarthModel& earth,
                                    double exaggeration = 1);

}  // namespace terray
