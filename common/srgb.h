#pragma once

#include <cstdint>

namespace terray {

/// Linear light, 0..1, of an 8-bit sRGB value. Source: IEC 61966-2-1:1999.
[[nodiscard]] float linearFromSrgb(uint8_t value);

/// The 8-bit sRGB value nearest to a linear light (clamped to 0..1), as if the sRGB curve were evaluated in double and
/// rounded: by a search among the 255 limits between values, so exact, and linearFromSrgb() returns to where it came
/// from.
[[nodiscard]] uint8_t srgbFromLinear(float light);

}  // namespace terray
