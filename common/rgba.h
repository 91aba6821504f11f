#pragma once

#include <array>
#include <cstdint>

namespace terray {

/// 8-bit red, green, blue and alpha. Colours are sRGB; what alpha says is stated where it is used.
using Rgba = std::array<uint8_t, 4>;

}  // namespace terray
