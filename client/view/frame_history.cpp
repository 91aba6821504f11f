#include "client/view/frame_history.h"

#include <algorithm>
#include <span>

#include "common/percentile.h"

namespace terray {

void FrameHistory::add(double milliseconds, double seconds, uint64_t bytesRead) {
    if (frames_.size() == kFrames) frames_.erase(frames_.begin());
    frames_.push_back({milliseconds, seconds, bytesRead});
}

std::vector<float> FrameHistory::milliseconds() const {
    std::vector<float> all;
    for (const Frame& frame : frames_) all.push_back(static_cast<float>(frame.ms));
    return all;
}

double FrameHistory::percentileMs(double percent) const {
    if (frames_.empty()) return 0;
    std::vector<float> sorted = milliseconds();
    std::sort(sorted.begin(), sorted.end());
    return percentile(std::span<const float>(sorted), percent);
}

double FrameHistory::bytesPerSecond(double seconds) const {
    const auto first = std::find_if(frames_.begin(), frames_.end(),
                                    [&](const Frame& frame) { return frame.seconds >= seconds - kRateSeconds; });
    if (first == frames_.end()) return 0;
    return static_cast<double>(frames_.back().bytesRead - first->bytesRead) / kRateSeconds;
}

}  // namespace terray
