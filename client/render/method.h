#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "shaders/interop.h"

namespace terray {

/// How a node's visible surface is found. All else of a frame is the same for every method: tiles, pager, selection,
/// camera, G-buffer, shadows, resolve (design, section 6), so that what differs between two pictures is the method's.
enum class Method : uint8_t {
    /// Columns or bilinear patches along the maximum mipmap (papers 001, 000). Exact for the surface that is drawn.
    pyramid,
    /// The same without the mipmap's upper levels: from sample to sample (paper 001's baseline). Exact, and slow.
    march,
    /// Uniform steps through the node's box, more for flat rays, then halving (paper 003). Misses what is thinner along
    /// the ray than a step.
    linear,
    /// A coarse mesh, pushed up above the ground and rasterised; from it steps of one length or doubling ones, more and
    /// longer ones for rays that missed, then the secant method (paper 002). Misses what its steps do not reach or step
    /// over.
    hull,
    /// Triangles of the tile, made when it is loaded, rasterised (paper 001's rival). Off by up to its tolerance beside
    /// the tile's own error.
    mesh,
    /// Relaxed cones over blocks of samples, stepped through (Policarpo and Oliveira 2007). Misses what its steps do
    /// not reach.
    cones,
    /// Node by node mesh or pyramid, whichever DrawCosts tells to be cheaper (paper 001, section 6).
    hybrid,
};

/// A method's name on command lines and its define in shaders ("": the pyramid's own program casts its rays).
struct MethodEntry {
    Method method;
    std::string_view name;
    std::string_view define;
    bool geometry = false;  ///< rasterises its own (GeometryPass), so only the raster launch draws it
};
inline constexpr std::array<MethodEntry, 7> kMethods = {{
    {Method::pyramid, "pyramid", ""},
    {Method::march, "march", ""},
    {Method::linear, "linear", "TERRAY_METHOD_LINEAR"},
    {Method::hull, "hull", "TERRAY_METHOD_HULL", true},
    {Method::mesh, "mesh", "TERRAY_METHOD_MESH", true},
    {Method::cones, "cones", "TERRAY_METHOD_CONES"},
    {Method::hybrid, "hybrid", "", true},
}};
[[nodiscard]] constexpr const MethodEntry& entryOf(Method method) {
    return kMethods[static_cast<size_t>(method)];
}

/// A method and what it searches by. Defaults are its paper's; fields of other methods mean nothing.
struct MethodOptions {
    Method method = Method::pyramid;
    // linear
    double least = 128;   ///< samples of a vertical ray's way through a box
    double most = 512;    ///< of a horizontal ray's
    double halvings = 8;  ///< of the last step
    // hull
    double quads = 32;       ///< along a tile's side
    double steps = 5;        ///< from the mesh on
    double more = 10;        ///< of rays that met nothing
    double coarser = 2;      ///< length of each of these, in strides
    double stride = 0.8;     ///< length of a step, in quads
    double exponential = 0;  ///< 1: steps that double up to the box's exit instead, and no more
    double secants = 2;      ///< at last
    // mesh, hybrid: greatest distance of triangles from the samples, over the greater of the tile's own error and a
    // quarter sample
    double error = 0.5;
    // cones
    double blocks = 128;      ///< along a tile's side
    double reach = 16;        ///< blocks, how far ground is looked at for a cone, and the longest step
    double coneSteps = 128;   ///< through a node
    double coneHalvings = 6;  ///< of the last step

    bool operator==(const MethodOptions&) const = default;
};

/// A number of MethodOptions that is set as METHOD:KEY=VALUE.
struct MethodKey {
    Method method;
    std::string_view key;
    double MethodOptions::*value;
    double lowest;
    double highest;
    enum class Kind : uint8_t { any, whole, powerOfTwo } kind;
};
inline constexpr std::array<MethodKey, 16> kMethodKeys = {{
    {Method::linear, "least", &MethodOptions::least, 1, 65536, MethodKey::Kind::whole},
    {Method::linear, "most", &MethodOptions::most, 1, 65536, MethodKey::Kind::whole},
    {Method::linear, "halvings", &MethodOptions::halvings, 0, 32, MethodKey::Kind::whole},
    {Method::hull, "quads", &MethodOptions::quads, 16, 256, MethodKey::Kind::powerOfTwo},
    {Method::hull, "steps", &MethodOptions::steps, 1, 65536, MethodKey::Kind::whole},
    {Method::hull, "more", &MethodOptions::more, 0, 65536, MethodKey::Kind::whole},
    {Method::hull, "coarser", &MethodOptions::coarser, 0.01, 1000, MethodKey::Kind::any},
    {Method::hull, "stride", &MethodOptions::stride, 1e-4, 1e4, MethodKey::Kind::any},
    {Method::hull, "exponential", &MethodOptions::exponential, 0, 1, MethodKey::Kind::whole},
    {Method::hull, "secants", &MethodOptions::secants, 0, 32, MethodKey::Kind::whole},
    {Method::mesh, "error", &MethodOptions::error, 0, 100, MethodKey::Kind::any},
    {Method::hybrid, "error", &MethodOptions::error, 0, 100, MethodKey::Kind::any},
    {Method::cones, "blocks", &MethodOptions::blocks, 32, 512, MethodKey::Kind::powerOfTwo},
    {Method::cones, "reach", &MethodOptions::reach, 1, 512, MethodKey::Kind::whole},
    {Method::cones, "steps", &MethodOptions::coneSteps, 1, 65536, MethodKey::Kind::whole},
    {Method::cones, "halvings", &MethodOptions::coneHalvings, 0, 32, MethodKey::Kind::whole},
}};

/// What "NAME" or "NAME:KEY=VALUE,KEY=VALUE" says, all else by default. Throws Error(usage) naming what is unknown or
/// out of range.
[[nodiscard]] MethodOptions methodNamed(const std::string& text);

/// The method with those of its numbers that are not the default, as methodNamed reads it.
[[nodiscard]] std::string description(const MethodOptions& options);

/// What shaders see of them.
[[nodiscard]] interop::MethodParameters methodParameters(const MethodOptions& options);

}  // namespace terray
