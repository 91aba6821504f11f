#pragma once

#include <functional>

#include <glm/vec2.hpp>

#include "client/stream/flight.h"

namespace terray {

/// Least height that a camera may have over a place, metres; finite everywhere.
using LeastHeight = std::function<double(glm::dvec2 place)>;

/// Raises keys until the path, looked at 30 times a second of the flight, is nowhere too low: those around a place by
/// what lacks there, and if that does not settle all of them. Whatever is high enough stays as it is.
void keepAbove(Flight& flight, const LeastHeight& leastHeight);

/// A flight along the route of a few waypoints, with about five keys a second (64 to 5000 in all), each raised to a
/// smooth envelope of the least heights around it, and then kept above them.
[[nodiscard]] Flight flownAbove(const Flight& route, const LeastHeight& leastHeight);

}  // namespace terray
