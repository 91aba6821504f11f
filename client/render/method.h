#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace terray {

/// How a node's visible surface is found. All else of a frame is the same for every method: tiles, pager, selection,
/// camera, G-buffer, shadows, resolve (design, section 6), so that what differs between two pictures is the method's.
enum class Method : uint8_t {
    /// Columns or bilinear patches along the maximum mipmap (papers 001, 000). Exact for the surface that is drawn.
    pyramid,
    /// The same without the mipmap's upper levels: from sample to sample (paper 001's baseline). Exact, and slow.
    march,
};

/// A method's name on command lines and its define in shaders ("": the pyramid's own program draws it).
struct MethodEntry {
    Method method;
    std::string_view name;
    std::string_view define;
};
inline constexpr std::array<MethodEntry, 2> kMethods = {{
    {Method::pyramid, "pyramid", ""},
    {Method::march, "march", ""},
}};
[[nodiscard]] constexpr const MethodEntry& entryOf(Method method) {
    return kMethods[static_cast<size_t>(method)];
}

}  // namespace terray
