#pragma once

#include "common/bytes.h"
#include "common/grid.h"
#include "preprocess/raster_source.h"

namespace terray {

/// Compresses an image to BC1 (S3TC DXT1, opaque) by stb_dxt, high quality.
///
/// @param image  sRGB texels, both sides multiples of 4; alpha is ignored
/// @return       8 bytes for each 4 x 4 block, rows of blocks from the top
/// Built without stb (TERRAY_WITH_STB=0): throws Error(unsupported).
[[nodiscard]] Bytes encodeBc1(GridView<const Rgba> image);

}  // namespace terray
