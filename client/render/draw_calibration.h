#pragma once

#include "client/render/draw_costs.h"
#include "client/render/shader_library.h"

namespace terray {

/// What drawing costs by the context that is current: tiles of computed ground, triangulated more and less closely, are
/// drawn near and far, steeply and flatly, by rays and by triangles, and DrawCosts fitted to the times that took.
///
/// Takes some 5 s on two cores of a software rasteriser. GL thread only; changes GL state as TerrainRenderer does.
/// Throws Error(graphics) when a shader does not compile.
[[nodiscard]] DrawCosts calibratedCosts(const ShaderLibrary& shaders);

}  // namespace terray
