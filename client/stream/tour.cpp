#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "client/stream/flight.h"
#include "client/stream/ground_clearance.h"
#include "client/stream/ground_map.h"
#include "common/check.h"

namespace terray {
namespace {

constexpr double kPi = std::numbers::pi;

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

    /// The few waypoints of a flight, over `seconds`.
    [[nodiscard]] std::vector<FlightKey> waypoints(TourKind kind, double seconds) const;
    /// Least height of the camera over a place.
    [[nodiscard]] double leastHeight(glm::dvec2 place) const {
        return map_.highestNear(place, clearance_ + map_.cellSide()) + clearance_;
    }

  private:
    /// Waypoints by when they are reached, in shares of the flight.
    using Plan = std::vector<std::pair<double, Camera>>;
    [[nodiscard]] Plan planOf(TourKind kind) const;
    [[nodiscard]] Plan standard() const;
    [[nodiscard]] Plan lowAlong(glm::dvec2 from, glm::dvec2 to, double pitchDegrees) const;
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

Planner::Plan Planner::standard() const {
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

    Plan plan{
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
    return plan;
}

/// Straight on, near the ground all the way.
Planner::Plan Planner::lowAlong(glm::dvec2 from, glm::dvec2 to, double pitchDegrees) const {
    constexpr int kLegs = 8;
    Plan plan;
    for (int leg = 0; leg <= kLegs; ++leg) {
        const double share = leg / static_cast<double>(kLegs);
        plan.emplace_back(share, low(glm::mix(from, to, share), headingAlong(to - from), pitchDegrees));
    }
    return plan;
}

Planner::Plan Planner::planOf(TourKind kind) const {
    const glm::dvec2 entry = wellInside(summit_ - 0.5 * passLength() * along_);
    const glm::dvec2 exit = wellInside(summit_ + 0.5 * passLength() * along_);
    const glm::dvec3 peak(summit_, map_.highestNear(summit_, map_.cellSide()));
    const Radians ahead = headingAlong(along_);
    const auto turned = [](Radians heading, double degrees) { return heading + radiansFromDegrees(degrees); };
    switch (kind) {
        case TourKind::standard:
            break;
        case TourKind::takeOff: {
            Camera away{.position = over(exit, 0.15), .heading = ahead, .pitch = radiansFromDegrees(-10)};
            return {{0, low(entry, ahead, 0)},
                    {0.15, low(glm::mix(entry, exit, 0.02), ahead, 0)},
                    {0.4, low(glm::mix(entry, exit, 0.25), ahead, 4)},
                    {1, away}};
        }
        case TourKind::lowPass:
            return lowAlong(entry, exit, -8);
        case TourKind::climb: {
            const glm::dvec2 back = entry - 0.3 * extent_ * along_;
            return {{0, low(entry, ahead, -5)},
                    {0.3, lookingAt(over(entry, 0.02), peak)},
                    {1, lookingAt(over(back, 0.7), peak)}};
        }
        case TourKind::lookDown:
            return {{0, straightDown(entry, ahead)},
                    {0.6, straightDown(exit, ahead)},
                    {0.8, straightDown(exit, turned(ahead, 90))},
                    {1, straightDown(exit, turned(ahead, 180))}};
        case TourKind::horizonSweep: {
            Plan plan;
            for (int quarter = 0; quarter <= 4; ++quarter)
                plan.emplace_back(0.25 * quarter, low(summit_, turned(ahead, 90 * quarter), -5));
            return plan;
        }
        case TourKind::fastDash: {
            // The diagonal that goes nearer past the summit.
            const glm::dvec2 half(0.45 * width_, 0.45 * height_), other(-half.x, half.y);
            const glm::dvec2 fromMiddle = summit_ - middle_;
            const glm::dvec2 way =
                std::abs(glm::dot(fromMiddle, half)) >= std::abs(glm::dot(fromMiddle, other)) ? half : other;
            return lowAlong(middle_ - way, middle_ + way, -8);
        }
    }
    return standard();
}

std::vector<FlightKey> Planner::waypoints(TourKind kind, double seconds) const {
    std::vector<FlightKey> keys;
    for (const auto& [share, camera] : planOf(kind)) keys.push_back({share * seconds, camera});
    return keys;
}

}  // namespace

Flight standardTour(const TileSource& source, double seconds, TourKind kind) {
    TERRAY_CHECK_OP(seconds, >, 0.0);
    const GroundMap map = GroundMap::read(source);
    const Planner planner(map);
    const Flight route{.dataset = {}, .name = {}, .keys = planner.waypoints(kind, seconds)};
    Flight tour = flownAbove(route, [&](glm::dvec2 place) { return planner.leastHeight(place); });
    const auto* named = std::find_if(std::begin(kTourKinds), std::end(kTourKinds),
                                     [kind](const TourKindName& other) { return other.kind == kind; });
    tour.name = std::string(named->name) + (kind == TourKind::standard ? " tour" : " flight");
    return tour;
}

}  // namespace terray
