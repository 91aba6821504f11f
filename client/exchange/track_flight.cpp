#include "client/exchange/track_flight.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "client/stream/ground_clearance.h"
#include "common/check.h"

namespace terray {
namespace {

/// A place of the way and when it is passed.
struct Fix {
    double seconds = 0;
    glm::dvec3 position{0};
};

/// Where a path of fixes is at any time. Before its start and after its end it is mirrored through them, so that
/// averages there stay on them.
glm::dvec3 linear(const std::vector<Fix>& fixes, double seconds) {
    const double end = fixes.back().seconds;
    if (seconds < 0) return 2.0 * fixes.front().position - linear(fixes, std::min(-seconds, end));
    if (seconds > end) return 2.0 * fixes.back().position - linear(fixes, std::max(2 * end - seconds, 0.0));
    const auto next = std::upper_bound(fixes.begin() + 1, fixes.end() - 1, seconds,
                                       [](double time, const Fix& fix) { return time < fix.seconds; });
    const Fix& from = *(next - 1);
    return glm::mix(from.position, next->position, (seconds - from.seconds) / (next->seconds - from.seconds));
}

/// The path averaged around a time.
glm::dvec3 smooth(const std::vector<Fix>& fixes, double seconds, double deviation) {
    constexpr int kReach = 12;  // to 3 deviations on both sides, in quarters of one
    glm::dvec3 sum(0);
    double weights = 0;
    for (int n = -kReach; n <= kReach; ++n) {
        const double share = n / 4.0, weight = std::exp(-0.5 * share * share);
        sum += weight * linear(fixes, seconds + share * deviation);
        weights += weight;
    }
    return sum / weights;
}

/// The fixes in the dataset's world, as many as there are; times as the file gives them.
Result<std::vector<Fix>> placed(const Track& track, const Projection& projection, GroundHeights& ground) {
    std::vector<Fix> fixes;
    double height = 0;
    for (const auto& line : track.lines)
        for (const TrackPoint& point : line) {
            const auto plane = projection.plane(point.place);
            if (!plane) return plane.failure();
            if (point.height)
                height = *point.height;
            else
                height = ground.at(*plane).value_or(height);
            fixes.push_back({point.seconds.value_or(NAN), {*plane, height}});
        }
    return fixes;
}

/// Gives each fix its time of the flight, the first one 0, and leaves out those that time does not go on with.
std::vector<Fix> timed(std::vector<Fix> fixes, const TrackFlightOptions& options) {
    const bool hasTimes =
        std::none_of(fixes.begin(), fixes.end(), [](const Fix& fix) { return std::isnan(fix.seconds); });
    std::vector<Fix> result;
    double travelled = 0;
    for (size_t n = 0; n < fixes.size(); ++n) {
        if (n > 0) travelled += glm::distance(fixes[n].position, fixes[n - 1].position);
        const double seconds =
            hasTimes ? (fixes[n].seconds - fixes.front().seconds) / options.speed : travelled / options.metresPerSecond;
        if (result.empty() || seconds > result.back().seconds) result.push_back({seconds, fixes[n].position});
    }
    return result;
}

/// Towards a place ahead; where there is hardly any way to it, as before.
Camera towards(glm::dvec3 eye, glm::dvec3 ahead, double lookDownDegrees, const Camera& before) {
    constexpr double kNoWay = 0.01;  // metres
    constexpr double kSteepest = 60;
    const glm::dvec3 way = ahead - eye;
    const double level = std::hypot(way.x, way.y);
    Camera camera = before;
    camera.position = eye;
    if (level < kNoWay) return camera;
    camera.heading = Radians(std::atan2(way.x, way.y));
    const double pitch = std::clamp(std::atan2(way.z, level) * 180 / std::numbers::pi, -kSteepest, kSteepest);
    camera.pitch = radiansFromDegrees(std::clamp(pitch - lookDownDegrees, -90.0, 90.0));
    return camera;
}

}  // namespace

Result<Flight> flightAlong(const Track& track, const TrackFlightOptions& options, const Projection& projection,
                           GroundHeights& ground) {
    TERRAY_CHECK(options.speed > 0 && options.metresPerSecond > 0 && options.smoothing > 0 && options.lookAhead > 0);
    auto all = placed(track, projection, ground);
    if (!all) return all.failure();
    const std::vector<Fix> fixes = timed(std::move(*all), options);
    if (fixes.size() < 2) return Failure{"it holds fewer than two fixes at different times and places"};

    const double seconds = fixes.back().seconds, between = options.smoothing / 2;
    if (seconds / between > static_cast<double>(kMostTrackKeys))
        return Failure{"its flight of " + Json(seconds).dump(0) + " s would have more than " +
                       std::to_string(kMostTrackKeys) + " keys; fly it faster, or smooth it more"};
    const auto count = static_cast<size_t>(std::ceil(seconds / between));
    const auto pathAt = [&](double time) {
        return smooth(fixes, time, options.smoothing / 2) + glm::dvec3(0, 0, options.above);
    };
    Flight flight;
    Camera camera;
    for (size_t n = 0; n <= count; ++n) {
        const double time = seconds * static_cast<double>(n) / static_cast<double>(count);
        camera = towards(pathAt(time), pathAt(time + options.lookAhead), options.lookDown, camera);
        flight.keys.push_back({time, asWritten(camera)});
    }
    const double lowest = ground.lowest();
    keepAbove(flight, [&](glm::dvec2 place) { return ground.at(place).value_or(lowest) + options.clearance; });
    return flight;
}

}  // namespace terray
