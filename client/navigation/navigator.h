#pragma once

#include <functional>
#include <optional>

#include <glm/vec2.hpp>

#include "client/navigation/fly_to.h"
#include "client/navigation/ground.h"
#include "client/stream/camera.h"
#include "common/tiling.h"
#include "common/view.h"

namespace terray {

enum class NavigationMode : uint8_t {
    free,   ///< flies where it looks
    orbit,  ///< moves level, turns around grabbed ground
    map,    ///< looks straight down
    walk,   ///< eye height above the ground
};

/// Where to go, as long as it is held: each -1 .. 1, of full speed.
struct Motion {
    double right = 0;
    double ahead = 0;
    double up = 0;
    bool fast = false;  ///< kFast times the speed
    bool operator==(const Motion&) const = default;
};

/// What a camera is flown through.
struct NavigationScene {
    Ground* ground = nullptr;  ///< outlives the navigator
    GroundRect extent;         ///< of the dataset
    double lowest = 0;         ///< heights of the dataset, metres; lowest is also the floor where there is no ground
    double highest = 0;
    /// The view of a camera as it is drawn: size, earth, exaggeration.
    std::function<View(const Camera&)> view;
};

/// A camera that a person flies. It keeps at least kEyeHeight above the ground in every mode, and within a few extents
/// of the dataset; inputs that are not finite are ignored. One thread; costs microseconds.
///
/// Speed is speedFactor() times the height above the ground per second, so that the ground goes by at the same pace on
/// the picture; walking it is kWalkSpeed times it. Motion has momentum: velocity follows its goal by exp(-t /
/// kInertia), integrated exactly over steps of 1/120 s at most, so a flight hardly depends on the rate of frames.
///
/// Where ground is not known to its finest, a moving camera keeps above the highest it may be; one that was placed, and
/// rests, is not lifted by what is not known.
class Navigator {
  public:
    static constexpr double kEyeHeight = 1.7;  ///< metres
    static constexpr double kInertia = 0.25;   ///< seconds
    static constexpr double kWalkSpeed = 2;    ///< metres per second
    static constexpr double kFast = 4;

    Navigator(NavigationScene scene, const Camera& start);

    [[nodiscard]] const Camera& camera() const { return camera_; }
    [[nodiscard]] NavigationMode mode() const { return mode_; }
    /// Whether the next step may move the camera though nobody touches anything.
    [[nodiscard]] bool moving() const;
    [[nodiscard]] double speedFactor() const { return speedFactor_; }
    /// Metres from the camera straight down to the ground; none where there is none.
    [[nodiscard]] std::optional<double> heightOverGround() const;

    /// Puts the camera somewhere at once; it rests there.
    void place(const Camera& camera);
    /// Turning to the map looks straight down at once; from it, 45 degrees down.
    void setMode(NavigationMode mode);
    /// 0.001 .. pi - 0.001 radians.
    void setFieldOfView(Radians vertical);
    /// Multiplies the speed, which stays within 1/32 .. 32.
    void scaleSpeed(double factor);

    /// Time goes by. @param seconds  beyond half a second it counts as that
    void step(const Motion& motion, double seconds);
    /// Looks elsewhere; not while the map looks down: there only the heading turns.
    void turn(Radians right, Radians up);

    /// Takes hold of a point of the ground (of the drawn world); released by release(), place() and flights.
    void grab(const glm::dvec3& point);
    void release() { grabbed_.reset(); }
    [[nodiscard]] bool grabbing() const { return grabbed_.has_value(); }
    /// Brings the grabbed point to a pixel, as far as the ground allows.
    void dragTo(glm::dvec2 pixel);
    /// Turns around the grabbed point, which keeps its pixel as far as the ground allows.
    void orbit(Radians right, Radians up);
    /// Goes to `factor` times the distance of a point, which keeps its pixel.
    void zoom(const glm::dvec3& point, double factor);

    /// Flies there on a smooth arc; any other motion ends it.
    void flyTo(const Camera& goal);
    /// Flies to look at a point of the drawn world from nearby.
    void flyToLookAt(const glm::dvec3& point);
    [[nodiscard]] bool flying() const { return flight_.has_value(); }

  private:
    struct Glide {
        FlyTo path;
        double seconds = 0;
    };
    void moveFor(const Motion& motion, double seconds);
    [[nodiscard]] double speed(const Motion& motion) const;
    [[nodiscard]] glm::dvec3 goalVelocity(const Motion& motion) const;
    void setEye(const glm::dvec3& eye);
    /// The least height that a camera may have over a place, and what is not known of it counted in or not.
    [[nodiscard]] double floorOver(glm::dvec2 place, bool cautious) const;
    void keepAboveGround(bool cautious);
    void keepNear();

    NavigationScene scene_;
    Camera camera_;
    NavigationMode mode_ = NavigationMode::free;
    double speedFactor_ = 1;
    glm::dvec3 velocity_{0};  ///< of the drawn world, metres per second
    bool unsettled_ = true;   ///< placed where the ground is not known to its finest yet
    std::optional<glm::dvec3> grabbed_;
    std::optional<Glide> flight_;
};

}  // namespace terray
