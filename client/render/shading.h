#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/units.h"

namespace terray {

/// What the picture shows of the ground. Legends: client/README.md; source: paper 000, section 3.8 and figure 8.
enum class Shading : uint8_t {
    photo,        ///< lit; neutral ground where there is none
    light,        ///< neutral ground, lit
    height,       ///< hypsometric colours, lit
    depth,        ///< view depth
    level,        ///< level of the height tile, lit
    grid,         ///< edges of sample cells, lit
    normal,       ///< of the ground as drawn
    slope,        ///< of the dataset's ground
    contours,     ///< lit
    tiles,        ///< id of the height tile, lit
    residency,    ///< exact, or an ancestor stands in; lit
    error,        ///< projected error of the height tile against the tolerance, lit
    steps,        ///< of each pixel's ray, sky included
    shadowSteps,  ///< of each pixel's shadow rays
    sobel,        ///< the photo in paper 003's light: normals by a Sobel filter, ambient, diffuse and specular
};

/// All of them, with their names on command lines and their defines in shaders ("": none of its own).
struct ShadingMode {
    Shading shading;
    std::string_view name;
    std::string_view define;
};
inline constexpr std::array<ShadingMode, 15> kShadingModes = {{
    {Shading::photo, "photo", ""},
    {Shading::light, "light", ""},
    {Shading::height, "height", "TERRAY_SHADE_HEIGHT"},
    {Shading::depth, "depth", "TERRAY_SHADE_DEPTH"},
    {Shading::level, "level", "TERRAY_SHADE_LEVEL"},
    {Shading::grid, "grid", "TERRAY_SHADE_GRID"},
    {Shading::normal, "normal", "TERRAY_SHADE_NORMAL"},
    {Shading::slope, "slope", "TERRAY_SHADE_SLOPE"},
    {Shading::contours, "contours", "TERRAY_SHADE_CONTOURS"},
    {Shading::tiles, "tiles", "TERRAY_SHADE_TILES"},
    {Shading::residency, "residency", "TERRAY_SHADE_RESIDENCY"},
    {Shading::error, "error", "TERRAY_SHADE_ERROR"},
    {Shading::steps, "steps", "TERRAY_SHADE_STEPS"},
    {Shading::shadowSteps, "shadow-steps", "TERRAY_SHADE_SHADOW_STEPS"},
    {Shading::sobel, "sobel", "TERRAY_SHADE_SOBEL"},
}};

/// What a mode shows beside its own; all else is neither compiled, paged nor run for it.
struct ShadingNeeds {
    bool photo = false;       ///< sampled
    bool photoTiles = false;  ///< selected and paged
    bool light = false;       ///< sun, shadows and air
    bool sky = true;
    bool footprint = false;    ///< math/footprint.glsl beside the photo's
    bool measures = false;     ///< interop::ShadingParameters
    bool steps = false;        ///< counted by the march
    bool shadowSteps = false;  ///< counted by the shadow pass
};
[[nodiscard]] ShadingNeeds needsOf(Shading shading);

/// A mode and what it measures by.
struct ShadingOptions {
    Shading mode = Shading::photo;
    Metres lowest{0};  ///< heights of the dataset
    Metres highest{0};
    Metres contourInterval{0};  ///< > 0 for contours
    Pixels tolerance{1};        ///< of projected errors
};

/// The greatest of 1, 2, 5, 10, 20 ... (and 0.5, 0.2, 0.1 ...) metres that lays at least 20 lines over a range of
/// heights; 1 where there is no range.
[[nodiscard]] Metres automaticContourInterval(Metres lowest, Metres highest);

/// The mode in words, with the numbers that its legend needs: "contours, every 50 m, stronger every 250 m".
[[nodiscard]] std::string description(const ShadingOptions& shading);

}  // namespace terray
