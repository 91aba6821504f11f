#pragma once

#include <string>
#include <vector>

#include "client/engine/engine.h"

namespace terray {

/// A way to draw that is measured: a point of a curve of error against run time.
struct ErrorSetting {
    std::string curve;  ///< the method; points of one curve differ in one number
    std::string name;   ///< unique within a sweep
    EngineOptions options;
    double quantum = 0;  ///< metres: heights are drawn as if stored in such steps; 0: as they are stored
};

/// The settings of a sweep; all else is as in `base`.
///
///     ""          base alone
///     tolerance   of heights from 1/4 to 8 pixels, by doubling, for each surface
///     surface     auto, columns, bilinear
///     launch      raster, compute
///     anisotropy  1, 2, 4, 8, 16
///     method      each of kMethods, over the numbers that it searches by
///     photo       tolerance of the photo from 1/2 to 8 pixels, by doubling
///     quantum     heights as stored and in coarser steps from 5 cm to 10 m, bilinear at tolerance 1/4 pixel
///
/// Throws Error(usage) on any other name. @param storedQuantum  metres, the dataset's own
[[nodiscard]] std::vector<ErrorSetting> settingsOf(const std::string& sweep, const EngineOptions& base,
                                                   double storedQuantum);
/// The names of all sweeps, as "a|b|c".
[[nodiscard]] std::string sweepNames();

}  // namespace terray
