#pragma once

#include "client/navigation/ground.h"
#include "client/stream/camera.h"

namespace terray {

/// A smooth arc from one camera to another: it starts and ends at rest, rises for the distance, and is planned higher
/// than all that is known of the ground between.
class FlyTo {
  public:
    /// @param clearance  above the ground, metres, between the ends of the arc
    FlyTo(const Camera& from, const Camera& to, Ground& ground, Metres clearance);

    /// 1.2 to 5: more for farther goals.
    [[nodiscard]] double seconds() const { return seconds_; }
    /// @param seconds  since the start; beyond its ends the arc rests
    [[nodiscard]] Camera at(double seconds) const;
    [[nodiscard]] const Camera& goal() const { return to_; }

  private:
    Camera from_;
    Camera to_;
    double seconds_ = 0;
    double apex_ = 0;  ///< metres above the line between the ends, half way
};

}  // namespace terray
