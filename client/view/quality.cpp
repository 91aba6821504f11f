#include "client/view/quality.h"

#include <algorithm>
#include <cmath>

namespace terray {

void Quality::tell(double frameMs, double seconds, bool moving) {
    restedSeconds_ = moving ? 0 : restedSeconds_ + seconds;
    resting_ = restedSeconds_ >= kRestSeconds;
    if (targetFps_ <= 0 || !moving || !(frameMs > 0)) return;
    const double load = frameMs * targetFps_ / 1000;  // 1: just in time
    constexpr double kStill = 0.1, kDown = 0.25, kUp = 0.05;
    if (load > 1 + kStill) quality_ -= kDown * std::min(load - 1, 1.0);
    if (load < 1 - kStill) quality_ += kUp * (1 - load);
    quality_ = std::clamp(quality_, 0.0, 1.0);
}

double Quality::quality() const {
    return targetFps_ <= 0 || resting_ ? 1 : quality_;
}

double Quality::scale() const {
    // The upper half of the quality is pixels.
    const double share = std::clamp(2 * quality() - 1, 0.0, 1.0);
    return kLeastScale + (1 - kLeastScale) * std::round(4 * share) / 4;
}

double Quality::toleranceFactor() const {
    const double share = std::clamp(2 * quality(), 0.0, 1.0);
    return std::pow(kMostTolerance, 1 - share);
}

}  // namespace terray
