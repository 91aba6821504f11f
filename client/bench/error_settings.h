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
};

/// The settings of a sweep; all else is as in `base`.
///
///     ""          base alone
///     tolerance   of heights from 1/4 to 8 pixels, by doubling, for each surface
///     surface     auto, columns, bilinear
///     launch      raster, compute
///     anisotropy  1, 2, 4, 8, 16
///     method      each of kMethods
///
/// Throws Error(usage) on any other name.
[[nodiscard]] std::vector<ErrorSetting> settingsOf(const std::string& sweep, const EngineOptions& base);

}  // namespace terray
