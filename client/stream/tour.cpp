#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "client/stream/flight.h"
#include "client/stream/ground_map.h"
#include "common/check.h"

namespace terray {
namespace {

constexpr double kPi = std::numbers::pi;
/// How often the finished flight is checked against the ground.
constexpr double kChecksPerSecond = 30;

Radians headingAlong(glm::dvec2 direction) {
    return Radians(std::atan2(direction.x, direction.y));
}

/// A camera at a place that has its target in the middle of the picture.
Camera lookingAt(glm::dvec3 from, glm::dvec3 target) {
    const glm::dvec3 way = target - from;
    const double level = std::hypot(way.x, way.y);
    return {.position = from, .heading = headingAlong(glm::dvec2(way)), .pitch = Radians(std::atan2(way.z, level))};
}

/// The measures of a dataset that its tour is made from. Lengths scale with the extent.
class Planner {
  public:
    explicit Planner(const GroundMap& map) : map_(map) {
        const GroundRect& ground = map.bounds();
        width_ = ground.east - ground.west;
        height_ = ground.north - ground.south;
        extent_ = std::max(width_, height_);
        // Low enough to look across ridges rather than down on them, and at least a few cells of the map.
        clearance_ = std::max({0.006 * extent_, 0.02 * (map.highest() - map.lowest()), 2 * map.cellSide()});
        middle_ = {ground.west + width_ / 2, ground.south + height_ / 2};
        summit_ = map.summit(0.2);
        along_ = roughestDirection();
    }

    /// The tour's few waypoints, over `seconds`.
    [[nodiscard]] std::vector<FlightKey> waypoints(double seconds) const;
    /// Least height of the camera over a place.
    [[nodiscard]] double leastHeight(glm::dvec2 place) const {
        return map_.highestNear(place, clearance_ + map_.cellSide()) + clearance_;
    }

  private:
    [[nodiscard]] double passLength() const { return 0.3 * extent_; }
    [[nodiscard]] glm::dvec2 roughestDirection() const;
    [[nodiscard]] Camera low(glm::dvec2 place, Radians heading, double pitchDegrees) const;
    /// The nearest place that has a tenth of the ground's width and height between it and the edges.
    [[nodiscard]] glm::dvec2 wellInside(glm::dvec2 place) const {
        const glm::dvec2 half(0.4 * width_, 0.4 * height_);
        return glm::clamp(place, middle_ - half, middle_ + half);
    }
    [[nodiscard]] glm::dvec3 over(glm::dvec2 place, double extents) const {
        return {place, map_.highest() + extents * extent_};
    }
    [[nodiscard]] Camera straightDown(glm::dvec2 place, Radians heading) const {
        return {.position = over(place, 0.2), .heading = heading, .pitch = Radians(-kPi / 2)};
    }
    [[nodiscard]] Camera overview(double turnDegrees, double share) const;
    /// The edge that the pass points to: a place on it beside the summit, and the way out there.
    struct Edge {
        glm::dvec2 place;
        glm::dvec2 outward;
    };
    [[nodiscard]] Edge edgeAhead() const;

    const GroundMap& map_;
    double width_ = 0, height_ = 0, extent_ = 0, clearance_ = 0;
    glm::dvec2 middle_{0}, summit_{0}, along_{0, 1};
};

/// The direction in which a pass over the summit meets the most ups and downs, of 16.
glm::dvec2 Planner::roughestDirection() const {
    glm::dvec2 best(0, 1);
    double most = -1;
    for (int i = 0; i < 16; ++i) {
        const double angle = i * kPi / 8;
        const glm::dvec2 direction(std::sin(angle), std::cos(angle));
        const glm::dvec2 half = 0.5 * passLength() * direction;
        // Of the two ways along one line, the one that goes towards the middle of the ground.
        const double rough = map_.roughness(summit_ - half, summit_ + half) *
                             (glm::dot(direction, middle_ - summit_) >= 0 ? 1.0 : 0.999);
        if (rough <= most) continue;
        most = rough;
        best = direction;
    }
    return best;
}

Camera Planner::low(glm::dvec2 place, Radians heading, double pitchDegrees) const {
    return {.position = {place, leastHeight(place)}, .heading = heading, .pitch = radiansFromDegrees(pitchDegrees)};
}

Planner::Edge Planner::edgeAhead() const {
    const glm::dvec2 outward = std::abs(along_.x) * height_ > std::abs(along_.y) * width_
                                   ? glm::dvec2(along_.x < 0 ? -1 : 1, 0)
                                   : glm::dvec2(0, along_.y < 0 ? -1 : 1);
    const glm::dvec2 half(width_ / 2, height_ / 2);
    // Beside the summit, where there is ground rather than perhaps a padded corner.
    const glm::dvec2 across = glm::dvec2(1) - glm::abs(outward);
    return {across * summit_ + glm::abs(outward) * middle_ + outward * half, outward};
}

/// All of the ground across a share of the picture's width (above 1: the nearest corners lie outside it), from outside
/// one of its longer sides: that from which the view goes along with the pass.
Camera Planner::overview(double turnDegrees, double share) const {
    constexpr double kAspect = 16.0 / 9;
    const glm::dvec2 ahead =
        width_ >= height_ ? glm::dvec2(0, along_.y < 0 ? -1 : 1) : glm::dvec2(along_.x < 0 ? -1 : 1, 0);
    const GroundRect& ground = map_.bounds();
    return framing({.heading = headingAlong(ahead) + radiansFromDegrees(turnDegrees), .pitch = radiansFromDegrees(-30)},
                   {ground.west, ground.south, map_.lowest()}, {ground.east, ground.north, map_.highest()}, kAspect,
                   share);
}

std::vector<FlightKey> Planner::waypoints(double seconds) const {
    const glm::dvec2 side(along_.y, -along_.x);  // to the right of the pass
    const glm::dvec2 entry = wellInside(summit_ - 0.5 * passLength() * along_);
    const glm::dvec2 exit = wellInside(summit_ + 0.5 * passLength() * along_);
    const glm::dvec3 peak(summit_, map_.highestNear(summit_, map_.cellSide()));
    const Radians ahead = headingAlong(along_);
    const Edge edge = edgeAhead();
    const Radians outward = headingAlong(edge.outward);
    const glm::dvec2 inside = edge.place - 0.08 * extent_ * edge.outward;
    Camera down = straightDown(summit_ + 0.05 * extent_ * along_, ahead);
    down.heading = ahead + radiansFromDegrees(20);
    Camera back = low(edge.place, outward + Radians(kPi), -12);  // at the edge's height, but outside
    back.position += glm::dvec3(0.04 * extent_ * edge.outward, 0);

    std::vector<std::pair<double, Camera>> plan{
        {0.00, overview(0, 0.95)},  // from outside
        {0.12, overview(12, 1.15)},
        {0.19, lookingAt(over(entry - 0.3 * extent_ * along_, 0.12), peak)},  // descent
        {0.25, low(entry, ahead, -10)},                                       // low pass over rough ground
        {0.325, low(summit_, ahead, -8)},
        {0.40, low(exit, ahead, -10)},
        {0.43, low(wellInside(exit + 0.03 * extent_ * (along_ + side)), ahead + Radians(kPi / 2), -8)},  // turn
        {0.46, low(wellInside(exit + 0.06 * extent_ * side), ahead + Radians(kPi), -8)},
        {0.53, lookingAt(over(exit, 0.1), peak)},  // climb
        {0.57, straightDown(summit_, ahead)},      // straight down
        {0.63, down},
        {0.71, low(inside, outward, -20)},  // low, over the edge, then along it with the ground on the right
        {0.76, low(edge.place, outward + radiansFromDegrees(115), -12)},
        {0.80, back},
        {0.84, low(inside, outward + Radians(kPi), -5)},  // sweep of the horizon
    };
    for (int quarter = 1; quarter <= 4; ++quarter)
        plan.emplace_back(0.84 + 0.04 * quarter, low(inside, outward + Radians(kPi + quarter * kPi / 2), -5));

    std::vector<FlightKey> keys;
    for (const auto& [share, camera] : plan) keys.push_back({share * seconds, camera});
    return keys;
}

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
std::vector<FlightKey> denseKeys(const Flight& route, const Planner& planner) {
    constexpr double kKeysPerSecond = 5, kSmoothSeconds = 1;
    const double seconds = route.seconds();
    const auto count = static_cast<size_t>(std::clamp(seconds * kKeysPerSecond, 64.0, 5000.0));
    std::vector<FlightKey> keys;
    std::vector<double> least;
    for (size_t i = 0; i <= count; ++i) {
        const double time = seconds * static_cast<double>(i) / static_cast<double>(count);
        keys.push_back({time, route.at(time)});
        least.push_back(planner.leastHeight(glm::dvec2(keys.back().camera.position)));
    }
    const double perSecond = static_cast<double>(count) / seconds;
    const auto envelope = smoothEnvelope(least, static_cast<size_t>(std::clamp(kSmoothSeconds * perSecond, 1.0, 5.0)));
    for (size_t i = 0; i < keys.size(); ++i)
        keys[i].camera.position.z = std::max(keys[i].camera.position.z, envelope[i]);
    return keys;
}

/// Raises keys until the spline between them is high enough too. Raising all keys alike raises the spline by as much,
/// so the last resort always succeeds.
void raiseUntilClear(Flight& flight, const Planner& planner) {
    constexpr int kLocalRounds = 20;
    const auto checks = static_cast<size_t>(std::ceil(flight.seconds() * kChecksPerSecond));
    for (int round = 0; round <= kLocalRounds; ++round) {
        double worst = 0;
        std::vector<double> raise(flight.keys.size(), 0);
        for (size_t i = 0; i <= checks; ++i) {
            const double time =
                flight.seconds() * static_cast<double>(i) / static_cast<double>(std::max<size_t>(checks, 1));
            const glm::dvec3 place = flight.at(time).position;
            const double missing = planner.leastHeight(glm::dvec2(place)) - place.z;
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

}  // namespace

Flight standardTour(const TileSource& source, double seconds) {
    TERRAY_CHECK_OP(seconds, >, 0.0);
    const GroundMap map = GroundMap::read(source);
    const Planner planner(map);
    const Flight route{.dataset = {}, .name = {}, .keys = planner.waypoints(seconds)};
    Flight tour{.dataset = {}, .name = "standard tour", .keys = denseKeys(route, planner)};
    raiseUntilClear(tour, planner);
    return tour;
}

}  // namespace terray
