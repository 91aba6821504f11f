#pragma once
// Small maps and rays for the tests of the packet march.

#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "common/grid.h"
#include "common/view.h"
#include "tests/bench/packet_march/packet_march.h"

namespace terray::test {

struct TestMap {
    TestMap(std::string mapName, Grid<uint16_t> mapCodes);

    std::string name;
    Grid<uint16_t> codes;
    glm::vec3 extent;  ///< of the box from the first sample, code 0, to the last one and the greatest code
    float steepest;    ///< greatest difference of neighbours

    /// Codes by which a float march may misjudge heights for a ray that starts at `eye`: eight roundings of the heights
    /// and of the places that take part, the latter times the steepest slope.
    [[nodiscard]] float rounding(const MapRay& ray) const;
};

/// Mountains; white noise, where a patch's neighbours say nothing of it; terraces with cliffs; a plateau; a
/// shaft; one patch.
[[nodiscard]] std::vector<TestMap> testMaps();

/// Rays from above, beside and within the map in all directions, the same for the same seed.
[[nodiscard]] std::vector<MapRay> randomRays(const TestMap& map, size_t count, uint64_t seed);

/// Rays for which some quotient is 0 / 0, some time is met twice, or some direction is none.
[[nodiscard]] std::vector<MapRay> specialRays(const TestMap& map);

/// A view in the world of a map with 1 m samples and 1 m codes: x as in the map, y northwards, so negative in the map.
[[nodiscard]] View viewOf(const TestMap& map, glm::dvec3 eye, double azimuth, double pitch);
inline const AxisFrame kMapFrame{.origin = {0, 0, 0}, .scale = {1, -1, 1}};

/// Expects t to lie between the hits with the surface raised and lowered by what rounding may do. A ray that passes
/// over the map's border only, and never over its interior, may hit or miss.
void expectFirstContact(const TestMap& map, const MapRay& ray, double t);

}  // namespace terray::test
