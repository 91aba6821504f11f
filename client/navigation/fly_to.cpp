#include "client/navigation/fly_to.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace terray {
namespace {

/// 0 to 1, with no velocity and no acceleration at both ends.
double eased(double share) {
    return share * share * share * (share * (6 * share - 15) + 10);
}

/// 0 at both ends without velocity, 1 half way.
double bump(double share) {
    const double part = 4 * share * (1 - share);
    return part * part;
}

}  // namespace

FlyTo::FlyTo(const Camera& from, const Camera& to, Ground& ground, Metres clearance) : from_(from), to_(to) {
    const double way = glm::distance(glm::dvec2(from.position), glm::dvec2(to.position));
    const double whole = glm::distance(from.position, to.position);
    constexpr double kLeastSeconds = 1.2, kMostSeconds = 5;
    seconds_ = std::clamp(0.4 + 0.6 * std::log10(1 + whole), kLeastSeconds, kMostSeconds);
    apex_ = 0.1 * way;
    // Near the ends the arc is where the ends are, and the camera's own collision sees to it.
    constexpr int kLooks = 256;
    for (int look = kLooks / 16; look <= kLooks - kLooks / 16; ++look) {
        const double share = static_cast<double>(look) / kLooks;
        const glm::dvec3 line = glm::mix(from.position, to.position, eased(share));
        const auto below = ground.under(glm::dvec2(line));
        if (!below) continue;
        const double least = below->height + below->uncertainty + clearance.value();
        apex_ = std::max(apex_, (least - line.z) / bump(share));
    }
}

Camera FlyTo::at(double seconds) const {
    const double share = std::clamp(seconds / seconds_, 0.0, 1.0);
    if (share == 1) return to_;
    const double part = eased(share);
    Camera camera = from_;
    camera.position = glm::mix(from_.position, to_.position, part);
    camera.position.z += apex_ * bump(share);
    const double turn = std::remainder(to_.heading.value() - from_.heading.value(), 2 * std::numbers::pi);
    camera.heading = from_.heading + Radians(part * turn);
    camera.pitch = from_.pitch + part * (to_.pitch - from_.pitch);
    camera.verticalFov = from_.verticalFov + part * (to_.verticalFov - from_.verticalFov);
    return camera;
}

}  // namespace terray
