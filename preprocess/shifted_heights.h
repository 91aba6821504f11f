#pragma once

#include <memory>
#include <string>

#include "preprocess/raster_source.h"

namespace terray {

/// The same heights, measured in another vertical system: "EPSG:5773" and the like, or "ellipsoid".
///
/// PROJ is asked at samples up to 250 m apart, and linearly between them: on grids of 15' (EGM96) to a few millimetres.
/// Any window of it holds the same values as any other. Throws Error(georeference) when the sources do not all say
/// which one vertical system they are in, or PROJ cannot shift; Error(unsupported) without GDAL.
[[nodiscard]] std::unique_ptr<HeightSource> shiftHeights(std::unique_ptr<HeightSource> heights,
                                                         const std::string& verticalCrs);

}  // namespace terray
