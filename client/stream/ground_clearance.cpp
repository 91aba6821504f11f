#include "client/stream/ground_clearance.h"

#include <algorithm>
#include <cmath>

namespace terray {
namespace {

/// The greatest of the values at most `reach` places away, averaged over as many: smooth, and nowhere below the values.
std::vector<double> smoothEnvelope(const std::vector<double>& values, size_t reach) {
    const auto window = [&](const std::vector<double>& from, size_t i, auto&& combine) {
        const size_t first = i < reach ? 0 : i - reach, last = std::min(i + reach + 1, from.size());
        return combine(from.begin() + static_cast<ptrdiff_t>(first), from.begin() + static_cast<ptrdiff_t>(last));
    };
    std::vector<double> highest(values.size()), smooth(values.size());
    for (size_t i = 0; i < values.size(); ++i)
        highest[i] = window(values, i, [](auto begin, auto end) { return *std::max_element(begin, end); });
    for (size_t i = 0; i < values.size(); ++i)
        smooth[i] = window(highest, i, [](auto begin, auto end) {
            double sum = 0;
            for (auto it = begin; it != end; ++it) sum += *it;
            return sum / static_cast<double>(end - begin);
        });
    return smooth;
}

/// Many keys along the waypoints' spline, each at least as high as the ground around asks for.
std::vector<FlightKey> denseKeys(const Flight& route, const LeastHeight& leastHeight) {
    constexpr double kKeysPerSecond = 5, kSmoothSeconds = 1;
    const double seconds = route.seconds();
    const auto count = static_cast<size_t>(std::clamp(seconds * kKeysPerSecond, 64.0, 5000.0));
    std::vector<FlightKey> keys;
    std::vector<double> least;
    for (size_t i = 0; i <= count; ++i) {
        const double time = seconds * static_cast<double>(i) / static_cast<double>(count);
        keys.push_back({time, route.at(time)});
        least.push_back(leastHeight(glm::dvec2(keys.back().camera.position)));
    }
    const double perSecond = static_cast<double>(count) / seconds;
    const auto envelope = smoothEnvelope(least, static_cast<size_t>(std::clamp(kSmoothSeconds * perSecond, 1.0, 5.0)));
    for (size_t i = 0; i < keys.size(); ++i)
        keys[i].camera.position.z = std::max(keys[i].camera.position.z, envelope[i]);
    return keys;
}

}  // namespace

void keepAbove(Flight& flight, const LeastHeight& leastHeight) {
    // Raising all keys alike raises the spline by as much, so the last resort always succeeds.
    constexpr int kLocalRounds = 20;
    constexpr double kChecksPerSecond = 30;
    const auto checks = static_cast<size_t>(std::ceil(flight.seconds() * kChecksPerSecond));
    for (int round = 0; round <= kLocalRounds; ++round) {
        double worst = 0;
        std::vector<double> raise(flight.keys.size(), 0);
        for (size_t i = 0; i <= checks; ++i) {
            const double time =
                flight.seconds() * static_cast<double>(i) / static_cast<double>(std::max<size_t>(checks, 1));
            const glm::dvec3 place = flight.at(time).position;
            const double missing = leastHeight(glm::dvec2(place)) - place.z;
            if (missing <= 0) continue;
            worst = std::max(worst, missing);
            const auto next = std::upper_bound(flight.keys.begin(), flight.keys.end(), time,
                                               [](double t, const FlightKey& key) { return t < key.seconds; });
            const auto after = std::min(static_cast<size_t>(next - flight.keys.begin()), raise.size() - 1);
            for (const size_t key : {after, after - std::min<size_t>(after, 1)})
                raise[key] = std::max(raise[key], 1.1 * missing);
        }
        if (worst == 0) return;
        for (size_t i = 0; i < raise.size(); ++i)
            flight.keys[i].camera.position.z += round < kLocalRounds ? raise[i] : 1.001 * worst;
    }
}

Flight flownAbove(const Flight& route, const LeastHeight& leastHeight) {
    Flight flight{.dataset = route.dataset, .name = route.name, .keys = denseKeys(route, leastHeight)};
    keepAbove(flight, leastHeight);
    return flight;
}

}  // namespace terray
