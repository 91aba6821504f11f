#include "client/navigation/navigator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>

#include "client/navigation/grab.h"
#include "common/check.h"

namespace terray {
namespace {

constexpr double kQuarterTurn = std::numbers::pi / 2;
constexpr double kLongestFrame = 0.5;  // seconds: a program that stood still does not leap
constexpr double kLongestStep = 1.0 / 120;
constexpr double kAtRest = 1e-3;         // of the speed at which a camera may fly here
constexpr double kLeastSpeedHeight = 5;  // metres over ground that speed is taken from, at least
constexpr double kExtentsAway = 4;       // how far a camera may leave the dataset, in its diagonals

bool finite(const Camera& camera) {
    const glm::dvec3& place = camera.position;
    return std::isfinite(place.x + place.y + place.z) && std::isfinite(camera.heading.value()) &&
           std::isfinite(camera.pitch.value()) && std::isfinite(camera.verticalFov.value());
}

Radians turned(Radians heading, Radians by) {
    const double sum = std::fmod(heading.value() + by.value(), 4 * kQuarterTurn);
    return Radians(sum < 0 ? sum + 4 * kQuarterTurn : sum);
}

Radians tilted(Radians pitch, Radians by) {
    return Radians(std::clamp(pitch.value() + by.value(), -kQuarterTurn, kQuarterTurn));
}

double asInput(double value) {
    return std::isfinite(value) ? std::clamp(value, -1.0, 1.0) : 0;
}

}  // namespace

Navigator::Navigator(NavigationScene scene, const Camera& start) : scene_(std::move(scene)) {
    TERRAY_CHECK(scene_.ground != nullptr && scene_.view != nullptr);
    TERRAY_CHECK(finite(start));
    place(start);
}

bool Navigator::moving() const {
    if (flight_ || (unsettled_ && scene_.ground->learning())) return true;
    return glm::length(velocity_) > kAtRest * speed({});
}

std::optional<double> Navigator::heightOverGround() const {
    const auto below = scene_.ground->under(glm::dvec2(camera_.position));
    if (!below) return {};
    return camera_.position.z - below->height;
}

void Navigator::place(const Camera& camera) {
    if (!finite(camera)) return;
    camera_ = camera;
    velocity_ = glm::dvec3(0);
    flight_.reset();
    release();
    unsettled_ = true;
    keepNear();
    keepAboveGround(false);
}

void Navigator::setMode(NavigationMode mode) {
    if (mode == mode_) return;
    const bool wasMap = mode_ == NavigationMode::map;
    mode_ = mode;
    flight_.reset();
    release();
    if (mode == NavigationMode::map) camera_.pitch = Radians(-kQuarterTurn);
    if (wasMap) camera_.pitch = Radians(-kQuarterTurn / 2);
    if (mode == NavigationMode::walk) {
        camera_.pitch = Radians(0);
        keepAboveGround(true);
    }
}

void Navigator::setFieldOfView(Radians vertical) {
    if (!std::isfinite(vertical.value())) return;
    camera_.verticalFov = Radians(std::clamp(vertical.value(), 0.001, std::numbers::pi - 0.001));
}

void Navigator::scaleSpeed(double factor) {
    if (!(factor > 0)) return;
    speedFactor_ = std::clamp(speedFactor_ * factor, 1.0 / 32, 32.0);
}

double Navigator::speed(const Motion& motion) const {
    const double fast = motion.fast ? kFast : 1;
    if (mode_ == NavigationMode::walk) return fast * speedFactor_ * kWalkSpeed;
    const double height = heightOverGround().value_or(camera_.position.z - scene_.lowest);
    return fast * speedFactor_ * std::max(height, kLeastSpeedHeight);
}

glm::dvec3 Navigator::goalVelocity(const Motion& motion) const {
    const View view = viewOf(camera_, 1, 1);
    const glm::dvec3 level(-view.right.y, view.right.x, 0);  // where the heading points
    const bool free = mode_ == NavigationMode::free;
    const bool walking = mode_ == NavigationMode::walk;
    const glm::dvec3 zenith(0, 0, walking ? 0 : 1);
    glm::dvec3 way = asInput(motion.right) * view.right + asInput(motion.ahead) * (free ? view.forward : level) +
                     asInput(motion.up) * zenith;
    const double length = glm::length(way);
    if (length > 1) way /= length;  // slanting is not faster
    return speed(motion) * way;
}

void Navigator::step(const Motion& motion, double seconds) {
    if (!(seconds > 0)) return;
    seconds = std::min(seconds, kLongestFrame);
    if (motion.right != 0 || motion.ahead != 0 || motion.up != 0) flight_.reset();
    if (flight_) {
        flight_->seconds += seconds;
        camera_ = flight_->path.at(flight_->seconds);
        const bool over = flight_->seconds >= flight_->path.seconds();
        // By the time it arrives the ground there is known, and does not lift it for what it might be.
        (void)scene_.ground->under(glm::dvec2(flight_->path.goal().position));
        unsettled_ = false;
        if (over) flight_.reset();
        keepAboveGround(true);
        return;
    }
    const auto steps = static_cast<int>(std::ceil(seconds / kLongestStep));
    for (int n = 0; n < steps; ++n) moveFor(motion, seconds / steps);
}

void Navigator::moveFor(const Motion& motion, double seconds) {
    // Velocity tends to its goal exponentially; its integral in closed form does not depend on the step.
    const glm::dvec3 goal = goalVelocity(motion);
    const glm::dvec3 excess = velocity_ - goal;
    const double left = std::exp(-seconds / kInertia);
    const glm::dvec3 way = goal * seconds + excess * (kInertia * (1 - left));
    velocity_ = goal + left * excess;
    if (glm::length(velocity_) <= kAtRest * speed({}) && goal == glm::dvec3(0)) velocity_ = glm::dvec3(0);
    const double exaggeration = scene_.view(camera_).exaggeration;
    camera_.position += glm::dvec3(way.x, way.y, way.z / exaggeration);
    keepNear();
    if (way != glm::dvec3(0)) unsettled_ = false;
    keepAboveGround(true);
}

void Navigator::turn(Radians right, Radians up) {
    if (!std::isfinite(right.value() + up.value())) return;
    flight_.reset();
    camera_.heading = turned(camera_.heading, right);
    if (mode_ != NavigationMode::map) camera_.pitch = tilted(camera_.pitch, up);
}

void Navigator::grab(const glm::dvec3& point) {
    if (!std::isfinite(point.x + point.y + point.z)) return;
    flight_.reset();
    velocity_ = glm::dvec3(0);
    grabbed_ = point;
}

void Navigator::dragTo(glm::dvec2 pixel) {
    if (!grabbed_ || !std::isfinite(pixel.x + pixel.y)) return;
    if (const auto eye = eyeDragged(scene_.view(camera_), *grabbed_, pixel)) setEye(*eye);
}

void Navigator::orbit(Radians right, Radians up) {
    if (!grabbed_ || !std::isfinite(right.value() + up.value())) return;
    Camera next = camera_;
    next.heading = turned(next.heading, right);
    if (mode_ != NavigationMode::map) next.pitch = tilted(next.pitch, up);
    const View before = scene_.view(camera_), after = scene_.view(next);
    camera_.heading = next.heading;
    camera_.pitch = next.pitch;
    setEye(eyeOrbited(before, after, *grabbed_));
}

void Navigator::zoom(const glm::dvec3& point, double factor) {
    if (!std::isfinite(point.x + point.y + point.z) || !(factor > 0)) return;
    flight_.reset();
    velocity_ = glm::dvec3(0);
    setEye(eyeZoomed(scene_.view(camera_), point, std::clamp(factor, 0.1, 10.0)));
}

void Navigator::setEye(const glm::dvec3& eye) {
    const double exaggeration = scene_.view(camera_).exaggeration;
    const Camera before = camera_;
    camera_.position = {eye.x, eye.y, eye.z / exaggeration};
    if (!finite(camera_)) camera_ = before;
    unsettled_ = false;
    keepNear();
    keepAboveGround(true);
}

void Navigator::flyTo(const Camera& goal) {
    if (!finite(goal)) return;
    release();
    velocity_ = glm::dvec3(0);
    flight_ = Glide{FlyTo(camera_, goal, *scene_.ground, Metres(kEyeHeight))};
}

void Navigator::flyToLookAt(const glm::dvec3& point) {
    if (!std::isfinite(point.x + point.y + point.z)) return;
    constexpr double kNearer = 0.25, kLeastDistance = 30, kPitchDegrees = -30;
    const View view = scene_.view(camera_);
    const double distance = std::max(kLeastDistance, kNearer * glm::distance(point, view.eye));
    Camera goal = camera_;
    if (mode_ != NavigationMode::map) goal.pitch = radiansFromDegrees(kPitchDegrees);
    if (mode_ == NavigationMode::walk) goal.pitch = Radians(0);
    goal.position = point - distance * viewOf(goal, 1, 1).forward;
    if (mode_ == NavigationMode::walk) goal.position = point + glm::dvec3(0, 0, view.exaggeration * kEyeHeight);
    goal.position.z /= view.exaggeration;
    flyTo(goal);
}

double Navigator::floorOver(glm::dvec2 place, bool cautious) const {
    // A little around the place too, for steep ground beside the eye.
    constexpr double kAround = 1;  // metre
    double floor = -std::numeric_limits<double>::infinity();
    for (const glm::dvec2& by : {glm::dvec2(0, 0), {kAround, 0}, {-kAround, 0}, {0, kAround}, {0, -kAround}})
        if (const auto ground = scene_.ground->under(place + by))
            floor = std::max(floor, ground->height + (cautious ? ground->uncertainty : 0));
    return (std::isfinite(floor) ? floor : scene_.lowest) + kEyeHeight;
}

void Navigator::keepAboveGround(bool cautious) {
    const glm::dvec2 place(camera_.position);
    const auto below = scene_.ground->under(place);
    unsettled_ = unsettled_ && below && below->uncertainty > 0;
    const double floor = floorOver(place, cautious && !unsettled_);
    const bool walking = mode_ == NavigationMode::walk && !flight_;
    if (camera_.position.z >= floor && !walking) return;
    camera_.position.z = floor;
    velocity_.z = std::max(velocity_.z, 0.0);
}

void Navigator::keepNear() {
    const GroundRect& extent = scene_.extent;
    const double diagonal = std::hypot(extent.east - extent.west, extent.north - extent.south);
    const double away = kExtentsAway * diagonal;
    camera_.position.x = std::clamp(camera_.position.x, extent.west - away, extent.east + away);
    camera_.position.y = std::clamp(camera_.position.y, extent.south - away, extent.north + away);
    camera_.position.z = std::clamp(camera_.position.z, scene_.lowest - away, scene_.highest + away);
}

}  // namespace terray
