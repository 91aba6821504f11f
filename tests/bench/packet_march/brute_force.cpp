#include "tests/bench/packet_march/brute_force.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <glm/glm.hpp>

namespace terray {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr double kParallel = 1e-30;  // slower than this a ray does not change a coordinate at all

/// Adds where the coordinate eye + t * direction is 0, 1, .. last, for t > 0. @return false if the ray never is inside
bool addCrossings(double eye, double direction, int64_t last, std::vector<double>& crossings) {
    if (std::abs(direction) < kParallel) return eye >= 0 && eye <= static_cast<double>(last);
    for (int64_t line = 0; line <= last; ++line) {
        const double t = (static_cast<double>(line) - eye) / direction;
        if (t > 0) crossings.push_back(t);
    }
    return true;
}

/// First s in [0, 1] at which the parabola through (0, begin), (1/2, middle), (1, end) is not above 0; infinity
/// without.
double firstZero(double begin, double middle, double end) {
    if (begin <= 0) return 0;
    const double bend = 2 * (begin - 2 * middle + end);
    const double slope = end - begin - bend;
    const auto value = [&](double s) { return (bend * s + slope) * s + begin; };
    double below = 1;
    if (end > 0) {
        if (bend <= 0) return kNone;
        below = -slope / (2 * bend);  // the lowest point
        if (below <= 0 || below >= 1 || value(below) > 0) return kNone;
    }
    double above = 0;
    for (int i = 0; i < 60; ++i) {
        const double s = (above + below) / 2;
        (value(s) > 0 ? above : below) = s;
    }
    return below;
}

}  // namespace

double bilinearHeight(GridView<const uint16_t> codes, double x, double y) {
    const auto column = std::clamp<int64_t>(static_cast<int64_t>(std::floor(x)), 0, codes.width() - 2);
    const auto row = std::clamp<int64_t>(static_cast<int64_t>(std::floor(y)), 0, codes.height() - 2);
    const double u = x - static_cast<double>(column);
    const double v = y - static_cast<double>(row);
    return (1 - u) * (1 - v) * codes.at(column, row) + u * (1 - v) * codes.at(column + 1, row) +
           (1 - u) * v * codes.at(column, row + 1) + u * v * codes.at(column + 1, row + 1);
}

double bruteForceHit(GridView<const uint16_t> codes, const MapRay& ray, double raise) {
    const glm::dvec3 eye(ray.eye);
    const glm::dvec3 direction(ray.direction);
    std::vector<double> crossings{0};
    if (!addCrossings(eye.x, direction.x, codes.width() - 1, crossings)) return kNone;
    if (!addCrossings(eye.y, direction.y, codes.height() - 1, crossings)) return kNone;
    if (std::max(std::abs(direction.x), std::abs(direction.y)) < kParallel) {  // over one point for ever
        const double above = eye.z - bilinearHeight(codes, eye.x, eye.y) - raise;
        if (above <= 0) return 0;
        return direction.z < 0 ? above / -direction.z : kNone;
    }
    std::ranges::sort(crossings);

    for (size_t i = 0; i + 1 < crossings.size(); ++i) {
        const double begin = crossings[i];
        const double length = crossings[i + 1] - begin;
        const glm::dvec3 middle = eye + (begin + length / 2) * direction;
        if (middle.x < 0 || middle.y < 0 || middle.x > static_cast<double>(codes.width() - 1) ||
            middle.y > static_cast<double>(codes.height() - 1))
            continue;
        // All three heights from the patch that the middle lies over, so that they are of one parabola.
        const double column = std::min(std::floor(middle.x), static_cast<double>(codes.width() - 2));
        const double row = std::min(std::floor(middle.y), static_cast<double>(codes.height() - 2));
        const auto patch = codes.window({static_cast<int64_t>(column), static_cast<int64_t>(row), 2, 2});
        const auto above = [&](double t) {
            const glm::dvec3 place = eye + t * direction;
            return place.z - bilinearHeight(patch, place.x - column, place.y - row) - raise;
        };
        const double s = firstZero(above(begin), above(begin + length / 2), above(begin + length));
        if (s <= 1) return begin + s * length;
    }
    return kNone;
}

}  // namespace terray
