#include "client/navigation/flight_recorder.h"

#include <algorithm>
#include <utility>

namespace terray {

void FlightRecorder::add(double seconds, const Camera& camera) {
    if (keys_.empty()) start_ = seconds;
    const double time = seconds - start_;
    // Keys ascend strictly: of two at one time the later counts.
    if (!keys_.empty() && keys_.back().seconds >= time) keys_.pop_back();
    constexpr int kOfARest = 4;
    const bool rests = keys_.size() >= kOfARest && std::all_of(keys_.end() - kOfARest, keys_.end(),
                                                               [&](const auto& key) { return key.camera == camera; });
    if (rests) {
        keys_.end()[-2].seconds = keys_.back().seconds;
        keys_.pop_back();
    }
    keys_.push_back({time, camera});
}

Flight FlightRecorder::flight(std::string dataset, std::string name) const {
    return {.dataset = std::move(dataset), .name = std::move(name), .keys = keys_};
}

}  // namespace terray
