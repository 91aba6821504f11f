#pragma once

#include <deque>
#include <optional>

#include "client/stream/camera.h"

namespace terray {

/// Where a camera is going, told by where it has been: what lies ahead can then be loaded before it is seen.
///
/// Speed and turning rates are those of the last fifth of a second, and are taken to go on as they are. One thread.
class CameraMotion {
  public:
    /// The camera at a moment. @param seconds  on any clock, never less than before
    void observe(const Camera& camera, double seconds);
    /// The camera `seconds` after the last observation, its pitch kept within straight up and straight down; none while
    /// it rests, and before it has been seen twice.
    [[nodiscard]] std::optional<Camera> ahead(double seconds) const;

  private:
    struct Observation {
        Camera camera;
        double seconds = 0;
    };
    std::deque<Observation> recent_;  ///< oldest first; all but the oldest of the last fifth of a second
};

}  // namespace terray
