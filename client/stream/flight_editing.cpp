#include "client/stream/flight_editing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <glm/geometric.hpp>

#include "common/check.h"

namespace terray {
namespace {

std::string text(double seconds) {
    return Json(seconds).dump(0) + " s";
}

/// Why a key may not be at a time between two of the others, or nothing.
Result<void> fits(const Flight& flight, double seconds, ptrdiff_t before, ptrdiff_t after) {
    if (!(seconds >= 0 && seconds <= kMostFlightSeconds))
        return Failure{"a key cannot be at " + text(seconds) + ", expected 0 to " + text(kMostFlightSeconds)};
    const auto refuse = [&](ptrdiff_t other) {
        const double taken = flight.keys[static_cast<size_t>(other)].seconds;
        return Failure{"a key cannot be at " + text(seconds) + ": the key at " + text(taken) +
                       " is in the way (at least " + text(kLeastKeySeconds) + " lie between two keys)"};
    };
    // Half a microsecond of slack, so that 0.002 fits behind 0.001.
    constexpr double kGap = kLeastKeySeconds - 5e-7;
    if (before >= 0 && !(seconds - flight.keys[static_cast<size_t>(before)].seconds >= kGap)) return refuse(before);
    if (after < std::ssize(flight.keys) && !(flight.keys[static_cast<size_t>(after)].seconds - seconds >= kGap))
        return refuse(after);
    return {};
}

double turn(Radians from, Radians to) {
    return std::abs(std::remainder(to.value() - from.value(), 2 * std::numbers::pi));
}

/// How far a path of few keys is from the key that it should go through, in units of what is allowed.
double deviation(const Camera& path, const Camera& key, Metres place, Radians angle) {
    const double angles = std::max(
        {turn(path.heading, key.heading), turn(path.pitch, key.pitch), turn(path.verticalFov, key.verticalFov)});
    return std::max(glm::distance(path.position, key.position) / place.value(), angles / angle.value());
}

}  // namespace

Result<size_t> addKey(Flight& flight, double seconds, const Camera& camera) {
    const auto after = std::lower_bound(flight.keys.begin(), flight.keys.end(), seconds,
                                        [](const FlightKey& key, double time) { return key.seconds < time; });
    const ptrdiff_t index = after - flight.keys.begin();
    if (auto fit = fits(flight, seconds, index - 1, index); !fit) return fit.failure();
    flight.keys.insert(after, {seconds, asWritten(camera)});
    return static_cast<size_t>(index);
}

Result<void> deleteKey(Flight& flight, size_t key) {
    TERRAY_CHECK_OP(key, <, flight.keys.size());
    if (flight.keys.size() == 1) return Failure{"the only key of a flight cannot be deleted"};
    flight.keys.erase(flight.keys.begin() + static_cast<ptrdiff_t>(key));
    return {};
}

void moveKey(Flight& flight, size_t key, const Camera& camera) {
    TERRAY_CHECK_OP(key, <, flight.keys.size());
    flight.keys[key].camera = asWritten(camera);
}

Result<void> retimeKey(Flight& flight, size_t key, double seconds) {
    TERRAY_CHECK_OP(key, <, flight.keys.size());
    const auto index = static_cast<ptrdiff_t>(key);
    if (auto fit = fits(flight, seconds, index - 1, index + 1); !fit) return fit;
    flight.keys[key].seconds = seconds;
    return {};
}

Result<void> retimeFrom(Flight& flight, size_t key, double seconds) {
    TERRAY_CHECK_OP(key, <, flight.keys.size());
    const double later = seconds - flight.keys[key].seconds;
    // Those behind come along, so only what is before is in the way, and the end of time.
    if (auto fit = fits(flight, seconds, static_cast<ptrdiff_t>(key) - 1, std::ssize(flight.keys)); !fit) return fit;
    if (flight.seconds() + later > kMostFlightSeconds)
        return Failure{"the flight would take " + text(flight.seconds() + later) + ", expected at most " +
                       text(kMostFlightSeconds)};
    for (size_t i = key; i < flight.keys.size(); ++i) flight.keys[i].seconds += later;
    return {};
}

Result<void> setDuration(Flight& flight, double seconds) {
    if (flight.keys.size() < 2 || !(flight.seconds() > 0))
        return Failure{"a flight of one key has no duration to change"};
    double shortest = std::numeric_limits<double>::infinity();
    for (size_t i = 1; i < flight.keys.size(); ++i)
        shortest = std::min(shortest, flight.keys[i].seconds - flight.keys[i - 1].seconds);
    const double factor = seconds / flight.seconds();
    const double least = flight.seconds() * std::min(kLeastKeySeconds / shortest, 1.0);
    if (!(seconds >= least && seconds <= kMostFlightSeconds))
        return Failure{"the flight cannot take " + text(seconds) + ", expected " + text(least) + " to " +
                       text(kMostFlightSeconds) + " (its keys would lie too close)"};
    for (FlightKey& key : flight.keys) key.seconds *= factor;
    flight.keys.back().seconds = seconds;
    return {};
}

Flight thinned(const Flight& flight, Metres place, Radians angle) {
    TERRAY_CHECK_OP(place.value(), >, 0.0);
    TERRAY_CHECK_OP(angle.value(), >, 0.0);
    if (flight.keys.size() < 3) return flight;
    // Keys are added to the first and the last one until the spline through them is near all others.
    std::vector<bool> kept(flight.keys.size(), false);
    kept.front() = kept.back() = true;
    for (;;) {
        Flight few{.dataset = flight.dataset, .name = flight.name, .keys = {}};
        for (size_t i = 0; i < kept.size(); ++i)
            if (kept[i]) few.keys.push_back(flight.keys[i]);
        // In each stretch between kept keys the farthest one is kept, too.
        bool fits = true;
        size_t farthest = 0;
        double most = 1;
        for (size_t i = 1; i < kept.size(); ++i) {
            if (kept[i]) {
                if (most > 1) {
                    kept[farthest] = true;
                    fits = false;
                }
                most = 1;
                continue;
            }
            const double off = deviation(few.at(flight.keys[i].seconds), flight.keys[i].camera, place, angle);
            if (off > most) {
                most = off;
                farthest = i;
            }
        }
        if (fits) return few;
    }
}

std::vector<glm::dvec3> pathPoints(const Flight& flight, size_t between) {
    std::vector<glm::dvec3> points;
    for (size_t i = 0; i < flight.keys.size(); ++i) {
        points.push_back(flight.keys[i].camera.position);
        if (i + 1 == flight.keys.size()) break;
        const double start = flight.keys[i].seconds, span = flight.keys[i + 1].seconds - start;
        for (size_t n = 1; n <= between; ++n)
            points.push_back(
                flight.at(start + span * static_cast<double>(n) / static_cast<double>(between + 1)).position);
    }
    return points;
}

}  // namespace terray
