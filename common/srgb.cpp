#include "common/srgb.h"

#include <array>
#include <cmath>

namespace terray {
namespace {

/// The sRGB curve from a signal in 0..1 to light in 0..1 (IEC 61966-2-1).
double lightOf(double signal) {
    return signal <= 0.04045 ? signal / 12.92 : std::pow((signal + 0.055) / 1.055, 2.4);
}

struct Tables {
    /// Light of each value.
    std::array<float, 256> light{};
    /// limits[v]: light from which on v + 1 is nearer than v, so from where the signal is (v + 0.5) / 255.
    std::array<float, 256> limits{};
    /// Value at the start of each of 4096 equal steps of light: the search begins there and takes few steps, because
    /// values are at least 1.2 steps apart (0.0003 of light at the dark end).
    std::array<uint8_t, 4097> start{};

    Tables() {
        for (size_t value = 0; value < 256; ++value) {
            light[value] = static_cast<float>(lightOf(static_cast<double>(value) / 255));
            limits[value] =
                value == 255 ? INFINITY : static_cast<float>(lightOf((static_cast<double>(value) + 0.5) / 255));
        }
        for (size_t step = 0; step <= 4096; ++step) {
            size_t value = 0;
            while (static_cast<float>(step) / 4096 >= limits[value]) ++value;
            start[step] = static_cast<uint8_t>(value);
        }
    }
};

const Tables& tables() {
    static const Tables kTables;
    return kTables;
}

}  // namespace

float linearFromSrgb(uint8_t value) {
    return tables().light[value];
}

uint8_t srgbFromLinear(float light) {
    if (!(light > 0)) return 0;
    if (light >= 1) return 255;
    const Tables& table = tables();
    uint8_t value = table.start[static_cast<size_t>(light * 4096)];
    while (light >= table.limits[value]) ++value;
    return value;
}

}  // namespace terray
