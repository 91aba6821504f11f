#include "tests/bench/embree_rates/views.h"

#include <algorithm>
#include <cmath>

#include <glm/glm.hpp>

#include "common/units.h"

namespace terray {
namespace {

constexpr double kFieldOfViewDegrees = 50;  // vertical

/// azimuth: degrees from north to east; pitch: degrees above the horizon.
View look(glm::dvec3 eye, double azimuthDegrees, double pitchDegrees, int width, int height) {
    const double azimuth = radiansFromDegrees(azimuthDegrees).value();
    const double pitch = radiansFromDegrees(pitchDegrees).value();
    View view;
    view.eye = eye;
    view.forward = {std::sin(azimuth) * std::cos(pitch), std::cos(azimuth) * std::cos(pitch), std::sin(pitch)};
    view.right = {std::cos(azimuth), -std::sin(azimuth), 0};
    view.up = glm::cross(view.right, view.forward);
    view.tanHalfHeight = std::tan(radiansFromDegrees(kFieldOfViewDegrees / 2).value());
    view.width = width;
    view.height = height;
    return view;
}

struct Cell {
    int64_t x;
    int64_t y;
};

/// The highest sample that is at least an eighth of the map away from its border.
Cell summit(const Ground& ground) {
    const GridSize size = ground.codes.size();
    Cell best{size.width / 2, size.height / 2};
    for (int64_t y = size.height / 8; y < size.height - size.height / 8; ++y)
        for (int64_t x = size.width / 8; x < size.width - size.width / 8; ++x)
            if (ground.codes.at(x, y) > ground.codes.at(best.x, best.y)) best = {x, y};
    return best;
}

/// The direction, degrees, in which the ground stays highest for the next tenth of the map.
double ridgeAzimuth(const Ground& ground, Cell from) {
    const GridSize size = ground.codes.size();
    const int64_t reach = std::min(size.width, size.height) / 10;
    double best = 0;
    double highest = -1;
    for (int azimuth = 0; azimuth < 360; azimuth += 3) {
        const double angle = radiansFromDegrees(azimuth).value();
        double sum = 0;
        for (int64_t r = 1; r <= reach; ++r) {
            const auto distance = static_cast<double>(r);
            sum += ground.codes.at(from.x + std::lround(distance * std::sin(angle)),
                                   from.y - std::lround(distance * std::cos(angle)));
        }
        if (sum > highest) {
            highest = sum;
            best = azimuth;
        }
    }
    return best;
}

}  // namespace

std::vector<NamedView> benchmarkViews(const Ground& ground, int width, int height) {
    const GridSize size = ground.codes.size();
    const double extent = ground.spacing * static_cast<double>(std::min(size.width, size.height));
    const double top = ground.bottom + ground.quantum * std::ranges::max(ground.codes.cells());
    /// A place, as parts of the map from its upper left corner, so many metres above the ground there.
    const auto above = [&](double x, double y, double metres) {
        const Cell cell{static_cast<int64_t>(x * static_cast<double>(size.width)),
                        static_cast<int64_t>(y * static_cast<double>(size.height))};
        const glm::dvec3 place(static_cast<double>(cell.x), static_cast<double>(cell.y),
                               ground.codes.at(cell.x, cell.y));
        return ground.worldFromMap(place) + glm::dvec3(0, 0, metres);
    };
    glm::dvec3 oblique = above(0.2, 0.8, 0);
    oblique.z = top + 0.15 * extent;
    const Cell peak = summit(ground);
    const glm::dvec3 onPeak = ground.worldFromMap(
        {static_cast<double>(peak.x), static_cast<double>(peak.y), ground.codes.at(peak.x, peak.y)});
    return {{"straight down", look(above(0.5, 0.5, 0.3 * extent), 0, -90, width, height)},
            {"oblique", look(oblique, 45, -30, width, height)},
            {"horizon", look(above(0.03, 0.97, 0.035 * extent), 45, -3, width, height)},
            {"along a ridge",
             look(onPeak + glm::dvec3(0, 0, 0.002 * extent), ridgeAzimuth(ground, peak), -12, width, height)}};
}

}  // namespace terray
