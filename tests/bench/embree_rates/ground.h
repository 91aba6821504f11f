#pragma once

#include <cstdint>
#include <string>

#include <glm/vec3.hpp>

#include "common/grid.h"
#include "tests/bench/packet_march/picture_rays.h"

namespace terray {

/// A map that all casters see alike: its heights are bottom + quantum * code, for a mesh as for a march.
/// World: sample (i, j) lies at x = i * spacing, y = -j * spacing.
struct Ground {
    std::string name;
    Grid<uint16_t> codes;
    double spacing = 1;  ///< metres
    double quantum = 1;  ///< metres per code
    double bottom = 0;   ///< metres; height of code 0

    [[nodiscard]] double height(int64_t x, int64_t y) const { return bottom + quantum * codes.at(x, y); }
    /// The march's frame: columns, rows, codes.
    [[nodiscard]] AxisFrame mapFrame() const;
    [[nodiscard]] glm::dvec3 worldFromMap(glm::dvec3 place) const;
};

/// The relief of `terray-preprocess synth`: size squared samples of 1 m, the same for the same seed on every machine.
[[nodiscard]] Ground syntheticGround(int64_t size, uint64_t seed);

/// Row-major little-endian float32 heights in metres, `columns` in a row. Throws Error(input) when the file cannot be
/// read, has no whole number of rows, or has a height that is not finite (a mesh of one grid has no holes).
[[nodiscard]] Ground groundFromFile(const std::string& file, int64_t columns, double spacing);

}  // namespace terray
