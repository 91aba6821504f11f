#pragma once

#include <optional>

#include "client/stream/dataset_source.h"

namespace terray {

/// What BC1 does to a photo's texels, seen at a texel a pixel.
struct PhotoCompression {
    double flip = 0;  ///< mean over texels
    double psnr = 0;  ///< dB over red, green and blue as stored
};

/// Measured on the dataset alone: a tile of the level above the finest was compressed from means of 2 x 2 texels of the
/// photo, and these means are known from the four tiles beneath it, whose own compression four-fold averaging all but
/// removes: it adds about a quarter to the squared difference, 1 dB to the worse. Of up to 24 tiles spread over the
/// level. None without photo, or when it has one level.
/// Throws Error(dataset) when a tile cannot be had.
[[nodiscard]] std::optional<PhotoCompression> measurePhotoCompression(const TileSource& source);

}  // namespace terray
