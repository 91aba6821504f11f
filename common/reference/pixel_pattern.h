#pragma once

#include <cstddef>
#include <vector>

#include <glm/vec2.hpp>

namespace terray {

/// Pixels spread evenly over a picture, each at most once, the same ones every time: the first `count` that Halton's
/// sequence in bases 2 and 3 falls on. All pixels, row by row, when there are no more than that.
/// Source: Halton 1960, "On the efficiency of certain quasi-random sequences of points", Numer. Math. 2.
/// @param count  at least 1
[[nodiscard]] std::vector<glm::ivec2> pixelPattern(int width, int height, size_t count);

}  // namespace terray
