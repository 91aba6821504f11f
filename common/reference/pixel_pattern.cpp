#include "common/reference/pixel_pattern.h"

#include <cstdint>

#include "common/grid.h"

namespace terray {
namespace {

/// The digits of a number in a base, mirrored at the point: 0 .. 1.
double radicalInverse(uint64_t number, uint64_t base) {
    double result = 0;
    double digit = 1.0 / static_cast<double>(base);
    for (; number > 0; number /= base) {
        result += static_cast<double>(number % base) * digit;
        digit /= static_cast<double>(base);
    }
    return result;
}

}  // namespace

std::vector<glm::ivec2> pixelPattern(int width, int height, size_t count) {
    TERRAY_CHECK_OP(count, >=, 1u);
    std::vector<glm::ivec2> pixels;
    if (count >= static_cast<size_t>(width) * static_cast<size_t>(height)) {
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) pixels.emplace_back(x, y);
        return pixels;
    }
    Grid<uint8_t> taken({width, height});
    for (uint64_t n = 1; pixels.size() < count; ++n) {
        const glm::ivec2 pixel(static_cast<int>(radicalInverse(n, 2) * width),
                               static_cast<int>(radicalInverse(n, 3) * height));
        if (taken.at(pixel.x, pixel.y)++ == 0) pixels.push_back(pixel);
    }
    return pixels;
}

}  // namespace terray
