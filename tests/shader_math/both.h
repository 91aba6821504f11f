#pragma once
// shaders/math in float (Single) and in double (Double) behind the same names, for tests typed over both.

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "shaders/math/math.h"

namespace terray::test {

#define TERRAY_PRECISION(Name, math)                                        \
    struct Name {                                                           \
        using real = math::real;                                            \
        using vec2 = math::vec2;                                            \
        using vec3 = math::vec3;                                            \
        using ivec2 = math::ivec2;                                          \
        using Interval = math::Interval;                                    \
        using Clearance = math::Clearance;                                  \
        using Corners = math::Corners;                                      \
        using Footprint = math::Footprint;                                  \
        static constexpr auto* safeInverse = math::safeInverse;             \
        static constexpr auto* boxInterval = math::boxInterval;             \
        static constexpr auto* blockEdge = math::blockEdge;                 \
        static constexpr auto* edgeTimes = math::edgeTimes;                 \
        static constexpr auto* cellAfter = math::cellAfter;                 \
        static constexpr auto* levelAfter = math::levelAfter;               \
        static constexpr auto* cellAt = math::cellAt;                       \
        static constexpr auto* meetsColumn = math::meetsColumn;             \
        static constexpr auto* columnTime = math::columnTime;               \
        static constexpr auto* clearanceAt = math::clearanceAt;             \
        static constexpr auto* firstContact = math::firstContact;           \
        static constexpr auto* riseTime = math::riseTime;                   \
        static constexpr auto* patchHeight = math::patchHeight;             \
        static constexpr auto* patchClearance = math::patchClearance;       \
        static constexpr auto* bentHeight = math::bentHeight;               \
        static constexpr auto* bentSlope = math::bentSlope;                 \
        static constexpr auto* lowestTime = math::lowestTime;               \
        static constexpr auto* bentMeetsColumn = math::bentMeetsColumn;     \
        static constexpr auto* bentColumnTime = math::bentColumnTime;       \
        static constexpr auto* earthDrop = math::earthDrop;                 \
        static constexpr auto* earthFall = math::earthFall;                 \
        static constexpr auto* projected = math::projected;                 \
        static constexpr auto* pixelFootprint = math::pixelFootprint;       \
        static constexpr auto* meanDecay = math::meanDecay;                 \
        static constexpr auto* airColumn = math::airColumn;                 \
        static constexpr auto* airColumnToSpace = math::airColumnToSpace;   \
        static constexpr auto* aerosolExtinction = math::aerosolExtinction; \
        static constexpr auto* moleculePhase = math::moleculePhase;         \
        static constexpr auto* aerosolPhase = math::aerosolPhase;           \
        static constexpr auto* heightAlong = math::heightAlong;             \
        static constexpr auto* cosineAlong = math::cosineAlong;             \
        static constexpr auto* horizonCosine = math::horizonCosine;         \
        static constexpr auto* seaDistance = math::seaDistance;             \
        static constexpr auto* leavingDistance = math::leavingDistance;     \
        static constexpr auto* enteringDistance = math::enteringDistance;   \
    };

TERRAY_PRECISION(Single, mathf)
TERRAY_PRECISION(Double, mathd)

#undef TERRAY_PRECISION

using Precisions = testing::Types<Single, Double>;

struct PrecisionNames {
    template <class Math>
    static std::string GetName(int /*index*/) {
        return std::is_same_v<Math, Single> ? "Float" : "Double";
    }
};

/// Half a last place of 1: the largest relative error of one operation.
template <class Math>
constexpr double kRoundoff = std::numeric_limits<typename Math::real>::epsilon() / 2.0;

/// safeInverse of each component.
template <class Math>
typename Math::vec3 inverseOf(typename Math::vec3 direction) {
    return {Math::safeInverse(direction.x), Math::safeInverse(direction.y), Math::safeInverse(direction.z)};
}

template <class Math>
typename Math::vec2 inverseOf(typename Math::vec2 direction) {
    return {Math::safeInverse(direction.x), Math::safeInverse(direction.y)};
}

/// The largest of what it is told, in units of a stated bound: stays at or below 1 when the bound holds. Reported with
/// the test's result, so that a bound that became loose or tight shows.
class Worst {
  public:
    explicit Worst(std::string name) : name_(std::move(name)) {}
    Worst(const Worst&) = delete;
    Worst& operator=(const Worst&) = delete;
    ~Worst() { testing::Test::RecordProperty(name_, std::to_string(worst_)); }

    /// Notes error / bound and whether it holds.
    [[nodiscard]] bool holds(double error, double bound) {
        const double part = error == 0.0 ? 0.0 : std::abs(error) / bound;
        if (!(part <= worst_)) worst_ = part;
        return part <= 1.0;
    }

  private:
    std::string name_;
    double worst_ = 0.0;
};

}  // namespace terray::test
