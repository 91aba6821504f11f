#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "common/grid.h"

namespace terray {

/// A line over the plane: its place at t is start + t * change.
struct PlaneLine {
    double startX = 0;
    double startY = 0;
    double changeX = 0;
    double changeY = 0;

    [[nodiscard]] double x(double t) const { return startX + t * changeX; }
    [[nodiscard]] double y(double t) const { return startY + t * changeY; }
};

/// A stretch of a line's parameter.
struct Stretch {
    double from = 0;
    double to = 0;
};

/// Visits, in order, the squares of a regular grid that a line crosses on a stretch: visit(column, row, stretch over
/// it) until that returns true. Square (i, j) covers [i, i + 1) x [j, j + 1) times `side`. Only squares within `range`
/// are visited; where the line leaves it the walk ends. Times are taken from the integers, so errors do not add up.
/// Source: Amanatides and Woo 1987, "A Fast Voxel Traversal Algorithm for Ray Tracing".
/// @return whether visit() did return true
template <class Visit>
bool walkSquares(const PlaneLine& line, double side, const GridRect& range, const Stretch& stretch, Visit visit) {
    const auto squareAt = [side](double place, int64_t first, int64_t count) {
        const double square = std::floor(place / side);
        return static_cast<int64_t>(
            std::clamp(square, static_cast<double>(first), static_cast<double>(first + count - 1)));
    };
    const auto leaveTime = [side](int64_t square, double start, double change) {
        if (change == 0) return std::numeric_limits<double>::infinity();
        return (static_cast<double>(square + (change > 0 ? 1 : 0)) * side - start) / change;
    };
    int64_t column = squareAt(line.x(stretch.from), range.x, range.width);
    int64_t row = squareAt(line.y(stretch.from), range.y, range.height);
    for (double from = stretch.from;;) {
        const double leaveX = leaveTime(column, line.startX, line.changeX);
        const double leaveY = leaveTime(row, line.startY, line.changeY);
        const double leave = std::min(leaveX, leaveY);
        const double to = std::clamp(leave, from, stretch.to);
        if (visit(column, row, Stretch{from, to})) return true;
        if (!(leave < stretch.to)) return false;
        if (leaveX <= leaveY) {
            column += line.changeX > 0 ? 1 : -1;
        } else {
            row += line.changeY > 0 ? 1 : -1;
        }
        if (column < range.x || column >= range.x + range.width) return false;
        if (row < range.y || row >= range.y + range.height) return false;
        from = to;
    }
}

}  // namespace terray
