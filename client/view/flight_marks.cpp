#include "client/view/flight_marks.h"

#include <algorithm>

#include <glm/geometric.hpp>

#include "client/overlay/shapes.h"
#include "client/stream/flight_editing.h"

namespace terray {
namespace {

constexpr size_t kMostPoints = 20'000;  // of the path; each makes 8 corners of 36 bytes
constexpr size_t kBetween = 24;         // points between two keys, where there are few
constexpr size_t kMostBalls = 500;      // more run together: a recorded flight is drawn as its path
// A thing as thin as this is always drawn as wide as its pixels say.
constexpr double kRadius = 0.05;
constexpr double kPathPixels = 1.5;
constexpr double kBallPixels = 4.5;
constexpr glm::vec3 kPathColour{1.0f, 0.75f, 0.05f};
constexpr glm::vec3 kKeyColour{0.95f, 0.95f, 0.95f};
constexpr glm::vec3 kSelectedColour{1.0f, 0.1f, 0.35f};

OverlayMesh tubes(const std::vector<std::vector<glm::dvec3>>& lines, double pixels, const glm::vec3& colour) {
    return tubeMesh(lines, {.radius = kRadius, .leastPixels = pixels, .colour = colour});
}

/// From a key along its camera's view: a tenth of the path's largest extent.
std::vector<glm::dvec3> lookOf(const Flight& flight, size_t key) {
    glm::dvec3 low = flight.keys[0].camera.position, high = low;
    for (const FlightKey& each : flight.keys) {
        low = glm::min(low, each.camera.position);
        high = glm::max(high, each.camera.position);
    }
    const double length = std::max({high.x - low.x, high.y - low.y, 100.0}) / 10;
    const Camera& camera = flight.keys[key].camera;
    return {camera.position, camera.position + length * viewOf(camera, 1, 1).forward};
}

/// Points between keys where these are few, a part of the keys where they are many.
std::vector<glm::dvec3> drawnPath(const Flight& flight) {
    const size_t keys = flight.keys.size();
    if (keys <= kMostPoints) return pathPoints(flight, std::min(kBetween, kMostPoints / keys - 1));
    std::vector<glm::dvec3> points;
    for (size_t n = 0; n < kMostPoints; ++n)
        points.push_back(flight.keys[n * (keys - 1) / (kMostPoints - 1)].camera.position);
    return points;
}

}  // namespace

std::vector<OverlayMesh> flightMarks(const Flight& flight, std::optional<size_t> selected) {
    std::vector<OverlayMesh> marks;
    if (flight.keys.empty()) return marks;
    marks.push_back(tubes({drawnPath(flight)}, kPathPixels, kPathColour));
    std::vector<std::vector<glm::dvec3>> balls;
    for (size_t key = 0; key < flight.keys.size() && flight.keys.size() <= kMostBalls; ++key)
        if (key != selected) balls.push_back({flight.keys[key].camera.position});
    if (!balls.empty()) marks.push_back(tubes(balls, kBallPixels, kKeyColour));
    if (selected) {
        marks.push_back(tubes({{flight.keys[*selected].camera.position}}, 1.3 * kBallPixels, kSelectedColour));
        marks.push_back(tubes({lookOf(flight, *selected)}, kPathPixels, kSelectedColour));
    }
    return marks;
}

}  // namespace terray
