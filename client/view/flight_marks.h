#pragma once

#include <optional>
#include <vector>

#include "client/stream/flight.h"
#include "common/overlay_mesh.h"

namespace terray {

/// What shows a flight in the terrain's picture: its path as a line, each key as a ball, the selected one in another
/// colour, with a line to where its camera looks. Lines and balls keep their size in pixels however far they are. None
/// without keys.
/// @param selected  index of a key
[[nodiscard]] std::vector<OverlayMesh> flightMarks(const Flight& flight, std::optional<size_t> selected);

}  // namespace terray
