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
};

/// A method's name on command lines and its define in shaders ("": the pyramid's own program draws it).
struct MethodEntry {
    Method method;
    std::string_view name;
    std::string_view define;
};
inline constexpr std::array<MethodEntry, 3> kMethods = {{
    {Method::pyramid, "pyramid", ""},
    {Method::march, "march", ""},
    {Method::linear, "linear", "TERRAY_METHOD_LINEAR"},
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

    bool operator==(const MethodOptions&) const = default;
};

/// A number of MethodOptions that is set as METHOD:KEY=VALUE.
struct MethodKey {
    Method method;
    std::string_view key;
    double MethodOptions::*value;
    double lowest;
    double highest;
    bool whole;
};
inline constexpr std::array<MethodKey, 3> kMethodKeys = {{
    {Method::linear, "least", &MethodOptions::least, 1, 65536, true},
    {Method::linear, "most", &MethodOptions::most, 1, 65536, true},
    {Method::linear, "halvings", &MethodOptions::halvings, 0, 32, true},
}};

/// What "NAME" or "NAME:KEY=VALUE,KEY=VALUE" says, all else by default. Throws Error(usage) naming what is unknown or
/// out of range.
[[nodiscard]] MethodOptions methodNamed(const std::string& text);

/// The method with those of its numbers that are not the default, as methodNamed reads it.
[[nodiscard]] std::string description(const MethodOptions& options);

/// What shaders see of them.
[[nodiscard]] interop::MethodParameters methodParameters(const MethodOptions& options);

}  // namespace terray
