#pragma once

#include <filesystem>

#include "client/render/draw_costs.h"
#include "client/render/shader_library.h"
#include "common/json.h"

namespace terray {

/// What drawing costs by the current context (DrawCosts): read from a file that this graphics card and driver have
/// written, else calibrated and written there in its place.
///
/// GL thread only. Throws Error(input) when the file is something else, Error(output) when it cannot be written.
/// @param file  JSON, client/README.md, "Methods"; empty: calibrated at each start
[[nodiscard]] DrawCosts settledDrawCosts(const std::filesystem::path& file, const ShaderLibrary& shaders);

/// As that file has them.
[[nodiscard]] Json toJson(const DrawCosts& costs);

}  // namespace terray
