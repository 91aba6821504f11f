#pragma once

#include <cstdint>

#include "common/grid.h"
#include "tests/bench/packet_march/packet_march.h"

namespace terray {

/// Height of the bilinear surface, codes. (x, y) in the map frame, inside the map.
[[nodiscard]] double bilinearHeight(GridView<const uint16_t> codes, double x, double y);

/// t at which a ray first touches the bilinear surface, raised by `raise` codes; infinity without. Solid ground.
///
/// A reference: it shares no code and no formula with the marches. All crossings of the ray with grid lines are sorted;
/// between two of them the ray's height above the surface is the parabola through three of its values, and its first
/// zero is bisected. Cost: about 0.1 microseconds a sample of the map's side.
[[nodiscard]] double bruteForceHit(GridView<const uint16_t> codes, const MapRay& ray, double raise = 0);

}  // namespace terray
