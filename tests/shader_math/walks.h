#pragma once
// Rays over whole grids, cell by cell, put together from the modules of shaders/math in one precision, and the same
// clearance in double by the surface's definition alone, to compare with. Frame: texels and codes, as in a tile; rays
// never run towards smaller x or y.

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "tests/shader_math/both.h"

namespace terray::test {

/// Heights at the integer points of a square, in codes. As columns, value (x, y) stands over [x, x + 1] x [y, y + 1];
/// as patches it is the corner at (x, y).
class Heights {
  public:
    template <class Function>
    Heights(int side, Function height) : side_(side) {
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) values_.push_back(static_cast<float>(height(x, y)));
    }

    [[nodiscard]] int side() const { return side_; }
    [[nodiscard]] float at(int x, int y) const { return values_[static_cast<size_t>(y * side_ + x)]; }
    [[nodiscard]] double highest() const { return *std::max_element(values_.begin(), values_.end()); }

    /// Largest difference between neighbours: codes per texel.
    [[nodiscard]] double steepest() const {
        double result = 0.0;
        for (int y = 0; y < side_; ++y)
            for (int x = 0; x < side_; ++x) {
                if (x + 1 < side_) result = std::max(result, std::abs(double{at(x, y)} - at(x + 1, y)));
                if (y + 1 < side_) result = std::max(result, std::abs(double{at(x, y)} - at(x, y + 1)));
            }
        return result;
    }

    /// The surface of patches in double, (x, y) clamped to the square.
    [[nodiscard]] double bilinear(double x, double y) const {
        const int column = std::clamp(static_cast<int>(std::floor(x)), 0, side_ - 2);
        const int row = std::clamp(static_cast<int>(std::floor(y)), 0, side_ - 2);
        const double u = std::clamp(x - column, 0.0, 1.0);
        const double v = std::clamp(y - row, 0.0, 1.0);
        return (1 - u) * (1 - v) * at(column, row) + u * (1 - v) * at(column + 1, row) +
               (1 - u) * v * at(column, row + 1) + u * v * at(column + 1, row + 1);
    }

    /// The surface of columns in double.
    [[nodiscard]] double column(double x, double y) const {
        return at(std::clamp(static_cast<int>(std::floor(x)), 0, side_ - 1),
                  std::clamp(static_cast<int>(std::floor(y)), 0, side_ - 1));
    }

  private:
    int side_;
    std::vector<float> values_;
};

template <class Math>
struct Ray {
    typename Math::vec3 eye;
    typename Math::vec3 direction;  // per metre of view depth; x, y >= 0
    typename Math::real bend = 0;

    [[nodiscard]] Ray<Double> exact() const { return {Double::vec3(eye), Double::vec3(direction), double{bend}}; }
    [[nodiscard]] double x(double t) const { return double{eye.x} + t * double{direction.x}; }
    [[nodiscard]] double y(double t) const { return double{eye.y} + t * double{direction.y}; }
    [[nodiscard]] double height(double t) const { return double{eye.z} + t * (double{direction.z} + double{bend} * t); }
};

/// What rounding may do to the clearance of a ray at t over patches: six roundings of what is added up, with the
/// horizontal ones lifted by the steepest slope (a patch's gradient is at most that of its edges, along x and along y).
template <class Math>
double clearanceBound(const Ray<Math>& ray, const Heights& heights, double t) {
    const double sideways = std::abs(double{ray.eye.x}) + std::abs(t * double{ray.direction.x}) +
                            std::abs(double{ray.eye.y}) + std::abs(t * double{ray.direction.y});
    const double up =
        std::abs(double{ray.eye.z}) + std::abs(t * double{ray.direction.z}) + std::abs(t * t * double{ray.bend});
    return 6 * kRoundoff<Math> * (up + heights.steepest() * sideways + heights.highest());
}

template <class Math>
using Contact = std::optional<typename Math::real>;  // t, metres of view depth

/// Contact within one cell, entered at `enter` and left at `leave`, with columns.
template <class Math>
Contact<Math> columnContact(const Heights& heights, const Ray<Math>& ray, typename Math::ivec2 cell,
                            typename Math::real enter, typename Math::real leave) {
    using real = typename Math::real;
    const real top = heights.at(cell.x, cell.y);
    if (ray.bend == real{0}) {
        if (!Math::meetsColumn(top, ray.eye.z, ray.direction.z, enter, leave)) return std::nullopt;
        return Math::columnTime(top, ray.eye.z, ray.direction.z, Math::safeInverse(ray.direction.z), enter, leave);
    }
    const real lowest = Math::lowestTime(ray.direction.z, ray.bend);
    if (!Math::bentMeetsColumn(top, ray.eye.z, ray.direction.z, ray.bend, lowest, enter, leave)) return std::nullopt;
    return Math::bentColumnTime(top, ray.eye.z, ray.direction.z, ray.bend, enter, leave);
}

/// The same with the patch between the four points of a cell.
template <class Math>
Contact<Math> patchContact(const Heights& heights, const Ray<Math>& ray, typename Math::ivec2 cell,
                           typename Math::real enter, typename Math::real leave) {
    using real = typename Math::real;
    const typename Math::Corners corners = {heights.at(cell.x, cell.y), heights.at(cell.x + 1, cell.y),
                                            heights.at(cell.x, cell.y + 1), heights.at(cell.x + 1, cell.y + 1)};
    const auto inside = [](real at) { return std::clamp(at, real{0}, real{1}); };
    const typename Math::vec3 at(inside(ray.eye.x + enter * ray.direction.x - static_cast<real>(cell.x)),
                                 inside(ray.eye.y + enter * ray.direction.y - static_cast<real>(cell.y)),
                                 Math::bentHeight(ray.eye.z, ray.direction.z, ray.bend, enter));
    const typename Math::vec3 direction(ray.direction.x, ray.direction.y,
                                        Math::bentSlope(ray.direction.z, ray.bend, enter));
    const real s = Math::firstContact(Math::patchClearance(corners, at, direction, ray.bend), leave - enter);
    if (s < real{0}) return std::nullopt;
    return std::min(enter + s, leave);
}

/// First contact of a ray within the first cells x cells cells of a grid, each cell entered where the last one was
/// left. contact: columnContact or patchContact.
template <class Math, class CellContact>
Contact<Math> walk(const Heights& heights, const Ray<Math>& ray, int cells, CellContact contact) {
    using real = typename Math::real;
    using vec2 = typename Math::vec2;
    const vec2 eye(ray.eye.x, ray.eye.y);
    const vec2 direction(ray.direction.x, ray.direction.y);
    const vec2 inverse = inverseOf<Math>(direction);
    const auto side = static_cast<real>(cells);
    const auto box = Math::boxInterval({eye.x, eye.y, real{0}}, {inverse.x, inverse.y, real{1}},
                                       {real{0}, real{0}, -real(1e30)}, {side, side, real(1e30)});
    if (!(box.enter <= box.exit)) return std::nullopt;
    const auto first = [&](real at) { return std::clamp(static_cast<int>(std::floor(at)), 0, cells - 1); };
    typename Math::ivec2 cell(first(eye.x + box.enter * direction.x), first(eye.y + box.enter * direction.y));
    for (real t = box.enter;;) {
        const auto edge = Math::blockEdge(cell, 0);
        const vec2 times = Math::edgeTimes(edge, eye, inverse);
        const real leave = std::max(t, std::min({times.x, times.y, box.exit}));
        if (const auto found = contact(heights, ray, cell, t, leave)) return found;
        if (leave >= box.exit) return std::nullopt;
        cell = Math::cellAfter(cell, edge, times, eye, direction);
        if (cell.x >= cells || cell.y >= cells) return std::nullopt;
        t = leave;
    }
}

template <class Math>
Contact<Math> walkColumns(const Heights& heights, const Ray<Math>& ray) {
    return walk<Math>(heights, ray, heights.side(), columnContact<Math>);
}

template <class Math>
Contact<Math> walkPatches(const Heights& heights, const Ray<Math>& ray) {
    return walk<Math>(heights, ray, heights.side() - 1, patchContact<Math>);
}

}  // namespace terray::test
