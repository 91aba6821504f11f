#include "client/stream/camera_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace terray {
namespace {

/// Long enough to even out frames of unequal length, short enough to follow a hand.
constexpr double kObservedSeconds = 0.2;
/// Of two frames that follow each other faster nothing can be told.
constexpr double kLeastSeconds = 1e-3;

/// The shorter way from one heading to another.
double turn(Radians from, Radians to) {
    return std::remainder(to.value() - from.value(), 2 * std::numbers::pi);
}

}  // namespace

void CameraMotion::observe(const Camera& camera, double seconds) {
    recent_.push_back({camera, seconds});
    while (recent_.size() > 2 && recent_[1].seconds <= seconds - kObservedSeconds) recent_.pop_front();
}

std::optional<Camera> CameraMotion::ahead(double seconds) const {
    if (recent_.size() < 2) return {};
    const Observation& first = recent_.front();
    const Observation& last = recent_.back();
    const double observed = last.seconds - first.seconds;
    const glm::dvec3 way = last.camera.position - first.camera.position;
    const double heading = turn(first.camera.heading, last.camera.heading);
    const double pitch = last.camera.pitch.value() - first.camera.pitch.value();
    const bool rests = way == glm::dvec3(0) && heading == 0 && pitch == 0;
    if (rests || observed < kLeastSeconds) return {};
    const double times = seconds / observed;
    Camera camera = last.camera;
    camera.position += way * times;
    camera.heading = Radians(camera.heading.value() + heading * times);
    camera.pitch =
        Radians(std::clamp(camera.pitch.value() + pitch * times, -std::numbers::pi / 2, std::numbers::pi / 2));
    return camera;
}

}  // namespace terray
