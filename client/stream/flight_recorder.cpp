#include "client/stream/flight_recorder.h"

#include <algorithm>
#include <utility>

#include "common/check.h"

namespace terray {
namespace {

/// Whether the last five keys are one pose: the middle one then says nothing.
bool restsLong(const std::vector<FlightKey>& keys) {
    constexpr ptrdiff_t kRest = 5;
    return std::ssize(keys) >= kRest && std::all_of(keys.end() - kRest, keys.end(), [&keys](const FlightKey& key) {
               return key.camera == keys.back().camera;
           });
}

}  // namespace

Camera FlightRecorder::record(double nowSeconds, const Camera& camera) {
    const Camera pose = asWritten(camera);
    if (keys_.empty()) start_ = nowSeconds;
    const double seconds = nowSeconds - start_;
    if (!keys_.empty() && !(seconds > keys_.back().seconds)) {
        keys_.back().camera = pose;
        return pose;
    }
    keys_.push_back({seconds, pose});
    if (restsLong(keys_)) keys_.erase(keys_.end() - 3);
    return pose;
}

Flight FlightRecorder::flight(std::string dataset, std::string name) const {
    TERRAY_CHECK(!keys_.empty());
    return {.dataset = std::move(dataset), .name = std::move(name), .keys = keys_};
}

}  // namespace terray
