#pragma once

#include <memory>
#include <string>

#include "preprocess/raster_source.h"

namespace terray {

/// What becomes of samples without data that lie within the sources' grid.
enum class NodataPolicy {
    holes,       ///< they stay holes
    sea,         ///< they lie at 0 m
    interpolate  ///< from heights within kFillDistance samples; what is farther stays a hole
};

/// How far interpolation reaches, in samples along either axis (as gdal_fillnodata does unless told otherwise).
inline constexpr int kFillDistance = 100;

/// "holes", "sea" or "interpolate", as the metadata name it.
[[nodiscard]] std::string nameOf(NodataPolicy policy);

/// The same heights without the holes that `policy` fills. Any window of it holds the same values as any other, so that
/// a dataset does not depend on how it is divided. Interpolation needs GDAL: throws Error(unsupported) without it.
[[nodiscard]] std::unique_ptr<HeightSource> fillNodata(std::unique_ptr<HeightSource> heights, NodataPolicy policy);

}  // namespace terray
