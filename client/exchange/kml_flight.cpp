#include <algorithm>
#include <cmath>
#include <utility>

#include "client/exchange/flight_files.h"
#include "client/stream/flight_editing.h"

namespace terray {
namespace {

Radians verticalFrom(double horizontalDegrees) {
    return Radians(2 * std::atan(std::tan(radiansFromDegrees(horizontalDegrees).value() / 2) / kKmlAspect));
}

double horizontalFrom(Radians vertical) {
    return degreesFromRadians(Radians(2 * std::atan(std::tan(vertical.value() / 2) * kKmlAspect)));
}

Result<Camera> cameraOf(const KmlView& view, const Projection& projection, GroundHeights& ground) {
    auto camera = cameraFrom(
        {.place = view.place, .height = view.altitude, .heading = view.heading, .pitch = view.tilt - 90}, projection);
    if (!camera) return camera.failure();
    if (view.mode != KmlAltitude::absolute)
        camera->position.z += ground.at(glm::dvec2(camera->position)).value_or(ground.lowest());
    if (view.horizontalFov) camera->verticalFov = verticalFrom(*view.horizontalFov);
    if (view.range) camera->position -= *view.range * viewOf(*camera, 1, 1).forward;
    return asWritten(*camera);
}

/// Builds keys from a playlist's steps.
class Playlist {
  public:
    void flyTo(const Camera& camera, const KmlStep& step) {
        if (keys_.empty()) {  // it flies there from wherever it was before
            keys_.push_back({0, camera});
        } else {
            const double arrival = keys_.back().seconds + step.seconds;
            if (atRest_) hold(keys_.back().seconds + kLeastKeySeconds);
            keys_.push_back({std::max(arrival, keys_.back().seconds + kLeastKeySeconds), camera});
        }
        atRest_ = !step.smooth;
    }

    /// Two keys of one pose at either end of a rest keep the spline still between them.
    void wait(double seconds) {
        if (keys_.empty() || seconds < 4 * kLeastKeySeconds) return;
        const double start = keys_.back().seconds;
        hold(start + kLeastKeySeconds);
        hold(start + seconds - kLeastKeySeconds);
        hold(start + seconds);
        atRest_ = false;
    }

    [[nodiscard]] std::vector<FlightKey> keys() && { return std::move(keys_); }

  private:
    void hold(double seconds) { keys_.push_back({seconds, keys_.back().camera}); }

    std::vector<FlightKey> keys_;
    bool atRest_ = false;  ///< the last key is, and the next one is still to say so
};

}  // namespace

Result<Flight> flightOf(const KmlTour& tour, const Projection& projection, GroundHeights& ground) {
    Playlist playlist;
    for (const KmlStep& step : tour.steps) {
        if (!step.view) {
            playlist.wait(step.seconds);
            continue;
        }
        const auto camera = cameraOf(*step.view, projection, ground);
        if (!camera) return camera.failure();
        playlist.flyTo(*camera, step);
    }
    return Flight{.dataset = {}, .name = tour.name, .keys = std::move(playlist).keys()};
}

Result<KmlTour> tourOf(const Flight& flight, const Projection& projection) {
    KmlTour tour{.name = flight.name, .steps = {}};
    double before = flight.keys.front().seconds;
    for (const FlightKey& key : flight.keys) {
        const auto camera = geographicCamera(key.camera, projection);
        if (!camera) return camera.failure();
        tour.steps.push_back({.seconds = key.seconds - before,
                              .view = KmlView{.place = camera->place,
                                              .altitude = camera->height,
                                              .mode = KmlAltitude::absolute,
                                              .heading = camera->heading,
                                              .tilt = std::clamp(camera->pitch + 90, 0.0, 180.0),
                                              .range = {},
                                              .horizontalFov = horizontalFrom(key.camera.verticalFov)},
                              .smooth = true});
        before = key.seconds;
        // The camera rests until its first key.
        if (tour.steps.size() == 1 && key.seconds > 0) tour.steps.push_back({.seconds = key.seconds});
    }
    return tour;
}

}  // namespace terray
