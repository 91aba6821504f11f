#include "client/navigation/tape.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace terray {
namespace {

constexpr int kPieces = 200;

Metres straightLength(glm::dvec2 from, glm::dvec2 to, const Projection* projection) {
    if (projection != nullptr) {
        const auto a = projection->lonLat(from), b = projection->lonLat(to);
        if (a && b) return geodesicDistance(*a, *b);
    }
    return Metres(glm::distance(from, to));
}

}  // namespace

TapeReading readTape(Ground& ground, glm::dvec2 from, glm::dvec2 to, const Projection* projection) {
    TapeReading reading{.straight = straightLength(from, to, projection)};
    std::optional<double> last;
    for (int piece = 0; piece <= kPieces; ++piece) {
        const glm::dvec2 place = glm::mix(from, to, static_cast<double>(piece) / kPieces);
        const auto below = ground.under(place);
        const double height = below ? below->height : last.value_or(0);
        reading.profile.emplace_back(place.x, place.y, height);
        const double rise = height - last.value_or(height);
        if (piece > 0)
            reading.alongGround = reading.alongGround + Metres(std::hypot(reading.straight.value() / kPieces, rise));
        reading.climb = reading.climb + Metres(std::max(rise, 0.0));
        if (below) last = height;
    }
    return reading;
}

}  // namespace terray
