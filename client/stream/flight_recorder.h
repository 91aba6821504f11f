#pragma once

#include <string>

#include "client/stream/flight.h"

namespace terray {

/// Records a flight, one key for each picture that is drawn. One thread.
///
/// What record() returns is what a saved flight gives back at that time, bit by bit: who draws that pose and later
/// replays the flight by its keys (terray-bench replay --at-keys) draws the same pictures.
class FlightRecorder {
  public:
    /// Takes the camera of a picture. A rest is kept as its first two and its last two poses, however long it is. Who
    /// draws on demand calls this at the end of a rest, too, with the pose that rested: between keys the camera flies.
    /// @param nowSeconds  of any steady clock; the first call is the flight's second 0. Where the clock has not moved
    /// on
    ///                    the pose takes the last one's place.
    /// @return            the pose as it is recorded, asWritten(camera)
    Camera record(double nowSeconds, const Camera& camera);

    [[nodiscard]] size_t keys() const { return keys_.size(); }
    [[nodiscard]] double seconds() const { return keys_.empty() ? 0 : keys_.back().seconds; }

    /// What was recorded; at least one pose must have been.
    [[nodiscard]] Flight flight(std::string dataset, std::string name) const;

  private:
    double start_ = 0;  ///< of the caller's clock
    std::vector<FlightKey> keys_;
};

}  // namespace terray
