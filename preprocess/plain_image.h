#pragma once

#include <string>

// What isPlainImage() asks the doors to the two raster libraries.

namespace terray {

/// Whether GDAL opens `file` and finds in it where it lies: a transform, or ground control points. Never without GDAL.
[[nodiscard]] bool hasGeoreference(const std::string& file);

/// Whether OpenImageIO opens `file`, and its first channel has a type that openImageHeights() reads exactly. Never
/// without OpenImageIO.
[[nodiscard]] bool isReadableImage(const std::string& file);

}  // namespace terray
