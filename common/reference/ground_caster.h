#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "common/reference/reference_heights.h"
#include "common/reference/square_walk.h"
#include "common/tiling.h"
#include "common/view.h"

namespace terray {

/// By how much a ground may be another one, `t` metres along a ray's view axis: room for what a march with numbers of
/// so many bits cannot tell apart. All are 0 or more.
struct Slack {
    /// a + b t
    struct Line {
        double a = 0;
        double b = 0;
        [[nodiscard]] double at(double t) const { return a + b * t; }
    };
    Line height;            ///< metres up or down, not exaggerated
    double heightBend = 0;  ///< the same per squared metre of t
    Line reach;             ///< samples: heights may be those of places this far to the side; below 1
    Line edge;              ///< samples: edges of the ground and of holes may lie this far to the side; at most 1/2
};

/// Which of the grounds that a slack allows. None that it allows is met before the grown one, or after the shrunk one.
enum class Extreme : int8_t {
    shrunk = -1,  ///< lower and narrower by the slack
    grown = 1,    ///< higher and wider
};

/// Truth: where a ray meets the finest samples as a bilinear surface, in double, on the CPU. It shares no code with the
/// shaders: no pyramid, no mirrored frame, no closed root. A ray is walked over squares of 512, of 16, of 1 patch,
/// those left out whose highest sample it clears; the first contact within a patch is found by bisection.
///
/// The ground. Between four sample centres lies a bilinear patch; each sample owns the quarter at its corner. A sample
/// without surface leaves its quarter open, and the patch's missing corner stands at the mean of those that exist; so
/// does the ground's rim, half a sample beyond the outermost centres. The ground is solid down to a floor: it is also
/// met through the sides of quarters, and a ray that starts within it meets it at once.
///
/// Error: the contact's t is off by some 2^-50 of itself, the numbers' own last places (2e-9 m at coordinates of 10^7 m
/// over `direction`'s steepness against the ground) aside. A ray that touches ground without crossing it, within these,
/// may be told either way. Proven against closed forms and dense marching in tests/reference.
///
/// Thread-safe. Squares of 512 patches are kept in memory up to a budget, the least recently used go first.
class GroundCaster {
  public:
    /// @param heights  outlives this object  @param floor  metres (height, not exaggerated), see above
    GroundCaster(const ReferenceHeights& heights, const Tiling& tiling, double floor,
                 uint64_t budgetBytes = 512ull << 20);
    ~GroundCaster();
    GroundCaster(const GroundCaster&) = delete;
    GroundCaster& operator=(const GroundCaster&) = delete;

    /// View depth, >= 0, at which a ray of a picture first meets the ground, straight or bent, exaggerated or not;
    /// none: sky. Directions as View::direction() gives them. Throws as ReferenceHeights::read().
    [[nodiscard]] std::optional<double> meet(const View& view, const glm::dvec3& direction) const;

    /// The same for the extreme of what a slack allows, or one beyond it: between sample centres the steepest slope
    /// of the patch and of those around it is taken for all of them. @param floor  in place of floor()
    [[nodiscard]] std::optional<double> meetExtreme(const View& view, const glm::dvec3& direction, const Slack& slack,
                                                    Extreme extreme, double floor) const;

    /// Height of the ground, metres, not exaggerated, at a place of the map; none where it has none.
    [[nodiscard]] std::optional<double> heightAt(double x, double y) const;

    /// The ground nearest to a place of the map that has none, at its edge, z not exaggerated: looked for in 16
    /// directions, so up to 2 % farther than the nearest of a straight edge; none within 256 finest samples.
    [[nodiscard]] std::optional<glm::dvec3> nearestEdge(double x, double y) const;

    /// Metres between samples.
    [[nodiscard]] double spacing() const { return tiling_.finestSpacing; }
    /// Metres, as given.
    [[nodiscard]] double floor() const { return floor_; }

  private:
    struct Ray;
    struct Square;
    struct Offset;
    struct Relief;
    using SquareId = std::pair<int64_t, int64_t>;  ///< row, column in squares of 512 patches
    using SquarePointer = std::shared_ptr<const Square>;

    [[nodiscard]] Ray rayOf(const View& view, const glm::dvec3& direction) const;
    /// The first contact of a ray, with the ground or, offset, with an extreme of it.
    [[nodiscard]] std::optional<double> meetGround(const Ray& ray, double floor, const Offset* offset) const;
    /// The first contact with a patch of an extreme of the ground.
    static std::optional<double> meetExtremeOfPatch(const Square& loaded, int64_t i, int64_t j, const Ray& ray,
                                                    const Stretch& stretch, const Offset& offset);
    /// The part of a ray over samples, up to `margin` of them beyond their edge, and not below the floor.
    [[nodiscard]] std::optional<Stretch> overGround(const Ray& ray, double floor, double margin) const;
    [[nodiscard]] double topOf(const GridRect& samples) const;
    [[nodiscard]] SquarePointer square(const SquareId& id) const;
    [[nodiscard]] SquarePointer load(const SquareId& id) const;

    const ReferenceHeights& heights_;
    Tiling tiling_;
    double floor_;
    size_t mostSquares_;
    mutable std::mutex mutex_;
    mutable std::list<std::pair<SquareId, SquarePointer>> recent_;  ///< most recently used first
    mutable std::map<SquareId, decltype(recent_)::iterator> loaded_;
};

}  // namespace terray
