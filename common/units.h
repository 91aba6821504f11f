#pragma once

#include <compare>
#include <numbers>

namespace terray {

/// A number with a unit in its type, so that metres cannot be passed for pixels.
///
/// Only what is meaningful for every unit is defined: sums, differences and scaling by a bare number, and the ratio of
/// two quantities of one unit. Anything else goes through value() and is then visible at the call.
template <class Unit>
class Quantity {
  public:
    constexpr Quantity() = default;
    explicit constexpr Quantity(double value) : value_(value) {}

    [[nodiscard]] constexpr double value() const { return value_; }

    constexpr auto operator<=>(const Quantity&) const = default;

    friend constexpr Quantity operator+(Quantity a, Quantity b) { return Quantity(a.value_ + b.value_); }
    friend constexpr Quantity operator-(Quantity a, Quantity b) { return Quantity(a.value_ - b.value_); }
    friend constexpr Quantity operator-(Quantity a) { return Quantity(-a.value_); }
    friend constexpr Quantity operator*(Quantity a, double factor) { return Quantity(a.value_ * factor); }
    friend constexpr Quantity operator*(double factor, Quantity a) { return Quantity(a.value_ * factor); }
    friend constexpr Quantity operator/(Quantity a, double divisor) { return Quantity(a.value_ / divisor); }
    friend constexpr double operator/(Quantity a, Quantity b) { return a.value_ / b.value_; }

  private:
    double value_ = 0;
};

using Metres = Quantity<struct MetreUnit>;
using Radians = Quantity<struct RadianUnit>;
using Pixels = Quantity<struct PixelUnit>;

/// Degrees appear only in options and files; everything inside is in radians.
[[nodiscard]] constexpr Radians radiansFromDegrees(double degrees) {
    return Radians(degrees * (std::numbers::pi / 180));
}
[[nodiscard]] constexpr double degreesFromRadians(Radians angle) {
    return angle.value() * (180 / std::numbers::pi);
}

}  // namespace terray
