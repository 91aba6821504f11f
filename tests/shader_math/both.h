#pragma once
// shaders/math in float (Single) and in double (Double) behind the same names, for tests typed over both.

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "shaders/math/precision.h"

namespace terray::test {

using math::Double;
using math::Single;

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
