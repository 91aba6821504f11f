#pragma once

#include "client/render/method.h"
#include "client/render/shader_library.h"
#include "client/render/shading.h"

namespace terray {

/// What a frame's programs contain. Each field adds a texture, a buffer, an output, a ray or a loop, so each is a
/// compile-time define; what is off is not compiled, not allocated, not run.
struct FeatureSet {
    bool imagery = false;     ///< TERRAY_IMAGERY: the photo's texture array and the footprint (paper 001, section 3.3)
    bool statistics = false;  ///< TERRAY_STATISTICS: steps per ray, counted into an image
    bool normals = false;     ///< TERRAY_NORMALS: an output of world normals beside colour
    bool signalSky = false;   ///< TERRAY_SIGNAL_SKY: pure magenta instead of sky, to count pixels without ground
    bool linearColour = false;  ///< not TERRAY_SRGB_COLOUR: colour is stored linear, not as sRGB bytes

    // Chosen by the renderer from the frame.
    bool occlusion = false;    ///< TERRAY_OCCLUSION: the march asks the ID pass (raster launch)
    bool photoProbes = false;  ///< TERRAY_PHOTO_PROBES: anisotropic filtering in the shader
    bool bilinear = false;     ///< TERRAY_BILINEAR: patches between sample centres, where samples are magnified
    bool curved = false;       ///< TERRAY_CURVED: rays bent over a curved earth
    bool sky = false;      ///< TERRAY_SKY: the sky of the sun's elevation and the light that comes with it (SkyTable)
    bool air = false;      ///< TERRAY_AIR: aerial perspective
    bool shadows = false;  ///< TERRAY_SHADOWS: a pass of rays to the sun, whose answer the resolve pass reads
    bool softSun = false;  ///< TERRAY_SOFT_SUN: several of them for each pixel, over the sun's disc
    /// TERRAY_SHADING and one of TERRAY_SHADE_...: what the ground shows in place of its photo. Photo and light have
    /// neither: light is the photo's program without imagery.
    Shading shading = Shading::photo;

    Method method = Method::pyramid;  ///< one of TERRAY_METHOD_..., or none of them: how the march finds the surface

    auto operator<=>(const FeatureSet&) const = default;

    /// What the programs that march depend on; all else is off, so that equal programs are compiled once.
    [[nodiscard]] FeatureSet marching() const;
    /// What the programs that resolve depend on, likewise.
    [[nodiscard]] FeatureSet resolving() const;
    /// What the programs of overlays depend on, likewise.
    [[nodiscard]] FeatureSet overlaying() const;

    /// What the programs that cast shadow rays depend on; these rays see patches everywhere.
    [[nodiscard]] FeatureSet shadowing() const;

    /// All defines, each 0 or 1, that any shader of this set is compiled with.
    [[nodiscard]] ShaderDefines defines() const;
};

}  // namespace terray
