#pragma once

#include "client/stream/flight.h"

namespace terray {

/// Records a camera as it is flown, a key for each frame, exactly. Of a rest only the first two and the last two frames
/// are kept: between these the flight's spline rests, too.
class FlightRecorder {
  public:
    /// @param seconds  on any clock; not before the last one
    void add(double seconds, const Camera& camera);
    /// What was recorded, from 0 seconds on.
    [[nodiscard]] Flight flight(std::string dataset, std::string name) const;

  private:
    std::vector<FlightKey> keys_;
    double start_ = 0;
};

}  // namespace terray
