#include "tests/bench/embree_rates/ground.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <vector>

#include "common/error.h"
#include "preprocess/synthetic_terrain.h"

namespace terray {
namespace {

/// Quantises heights in steps of a centimetre, or of as many times 2 that the codes reach.
Ground quantised(std::string name, GridView<const float> heights, double spacing) {
    Ground ground{.name = std::move(name), .codes = Grid<uint16_t>(heights.size()), .spacing = spacing};
    float least = heights.at(0, 0);
    float greatest = least;
    for (int64_t y = 0; y < heights.height(); ++y) {
        const auto [low, high] = std::ranges::minmax(heights.row(y));
        least = std::min(least, low);
        greatest = std::max(greatest, high);
    }
    ground.bottom = least;
    ground.quantum = 0.01;
    while ((greatest - least) / ground.quantum > 65535) ground.quantum *= 2;
    for (int64_t y = 0; y < heights.height(); ++y)
        std::ranges::transform(heights.row(y), ground.codes.view().row(y).begin(), [&](float height) {
            return static_cast<uint16_t>(std::lround((height - ground.bottom) / ground.quantum));
        });
    return ground;
}

}  // namespace

AxisFrame Ground::mapFrame() const {
    return {.origin = {0, 0, bottom}, .scale = {1 / spacing, -1 / spacing, 1 / quantum}};
}

glm::dvec3 Ground::worldFromMap(glm::dvec3 place) const {
    return {spacing * place.x, -spacing * place.y, bottom + quantum * place.z};
}

Ground syntheticGround(int64_t size, uint64_t seed) {
    const TerrainFunction terrain({.size = size, .spacing = 1, .seed = seed});
    Grid<float> heights({size, size});
    for (int64_t y = 0; y < size; ++y) terrain.heights(2, 4 * y + 2, 4, heights.view().row(y));
    return quantised("synthetic, seed " + std::to_string(seed), heights.view(), 1);
}

Ground groundFromFile(const std::string& file, int64_t columns, double spacing) {
    static_assert(std::endian::native == std::endian::little);
    std::ifstream in(file, std::ios::binary);
    std::error_code failure;
    const auto bytes = static_cast<int64_t>(std::filesystem::file_size(file, failure));
    if (!in || failure) throw Error(ExitCode::input, "cannot read heights from \"" + file + "\"");
    const int64_t rowBytes = columns * static_cast<int64_t>(sizeof(float));
    if (bytes == 0 || bytes % rowBytes != 0)
        throw Error(ExitCode::input, "\"" + file + "\" has " + std::to_string(bytes) + " bytes; expected rows of " +
                                         std::to_string(columns) + " float32 (--columns)");
    Grid<float> heights({columns, bytes / rowBytes});
    in.read(reinterpret_cast<char*>(heights.cells().data()), bytes);
    if (!in) throw Error(ExitCode::input, "cannot read all of \"" + file + "\"");
    if (!std::ranges::all_of(heights.cells(), [](float height) { return std::isfinite(height); }))
        throw Error(ExitCode::input, "\"" + file + "\" has heights that are not finite; holes are not compared");
    return quantised(std::filesystem::path(file).filename().string(), heights.view(), spacing);
}

}  // namespace terray
