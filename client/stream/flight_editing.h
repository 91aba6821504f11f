#pragma once

#include <cstddef>
#include <vector>

#include <glm/vec3.hpp>

#include "client/stream/flight.h"
#include "common/result.h"

namespace terray {

// Editing a flight key by key. Each operation leaves a flight that can be saved: at least one key, times ascending from
// 0 or later. One that would not fails with a sentence for people, and the flight is as before. Poses are taken
// asWritten(). `key` is an index below flight.keys.size().

/// Keys lie at least so far apart: a frame at 1000 a second.
inline constexpr double kLeastKeySeconds = 1e-3;

/// Puts a key between its neighbours in time. Fails where a key is nearer than kLeastKeySeconds. @return its index
[[nodiscard]] Result<size_t> addKey(Flight& flight, double seconds, const Camera& camera);
/// Fails for the only key.
[[nodiscard]] Result<void> deleteKey(Flight& flight, size_t key);
/// Puts the key's camera elsewhere; its time stays.
void moveKey(Flight& flight, size_t key, const Camera& camera);
/// Gives one key another time, between its neighbours'.
[[nodiscard]] Result<void> retimeKey(Flight& flight, size_t key, double seconds);
/// Gives a key another time and moves all later ones by as much: more or less time for the way to it.
[[nodiscard]] Result<void> retimeFrom(Flight& flight, size_t key, double seconds);
/// Stretches or shrinks all times so that the last key is at `seconds`. Fails for a flight of one key.
[[nodiscard]] Result<void> setDuration(Flight& flight, double seconds);

/// A flight through few of the given keys that comes as near to all others as told: few enough of a recorded flight to
/// edit. First and last stay; between two that stay, the farthest is taken until all are near enough.
/// @param place  of position  @param angle  of heading, pitch and field of view; both > 0
[[nodiscard]] Flight thinned(const Flight& flight, Metres place, Radians angle);

/// Eyes along the path for drawing it: each key's, and `between` more at even times to the next.
[[nodiscard]] std::vector<glm::dvec3> pathPoints(const Flight& flight, size_t between);

}  // namespace terray
