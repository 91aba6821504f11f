#include "preprocess/raster_layout.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <utility>

#include <sys/stat.h>

#include "common/check.h"

namespace terray {

namespace {

constexpr double kSameSpacing = 1e-6;  // relative
constexpr double kSamePlace = 0.01;    // of a cell: far below what resampling would blur
constexpr double kRounding = 1e-6;     // of a cell
constexpr double kMostCells = 1e15;    // along a side: far beyond what any raster library takes, and still exact

bool sameSpacing(double a, double b) {
    return std::abs(a - b) <= kSameSpacing * std::max(std::abs(a), std::abs(b));
}

double distanceToWhole(double value) {
    return std::abs(value - std::round(value));
}

}  // namespace

std::vector<PixelPlace> outlinePixels(GridSize size) {
    constexpr int kSteps = 100;
    constexpr int kInnerStep = 5;
    std::vector<PixelPlace> pixels;
    for (int i = 0; i <= kSteps; ++i)
        for (int j = 0; j <= kSteps; ++j) {
            const bool isOutline = i == 0 || i == kSteps || j == 0 || j == kSteps;
            if (!isOutline && (i % kInnerStep != 0 || j % kInnerStep != 0)) continue;
            pixels.push_back({static_cast<double>(size.width) * (static_cast<double>(i) / kSteps),
                              static_cast<double>(size.height) * (static_cast<double>(j) / kSteps)});
        }
    return pixels;
}

GroundRect SquareGrid::bounds() const {
    return {west, north - static_cast<double>(size.height) * spacing, west + static_cast<double>(size.width) * spacing,
            north};
}

bool isNorthUp(const GeoTransform& transform) {
    return transform[2] == 0 && transform[4] == 0 && transform[1] > 0 && transform[5] < 0;
}

std::optional<SquareGrid> squareGrid(const GeoTransform& transform, GridSize size) {
    if (!isNorthUp(transform) || !sameSpacing(transform[1], -transform[5])) return {};
    return SquareGrid{.west = transform[0], .north = transform[3], .spacing = transform[1], .size = size};
}

bool shareGrid(const GeoTransform& a, const GeoTransform& b) {
    return sameSpacing(a[1], b[1]) && sameSpacing(a[5], b[5]) && distanceToWhole((a[0] - b[0]) / a[1]) <= kSamePlace &&
           distanceToWhole((a[3] - b[3]) / a[5]) <= kSamePlace;
}

SquareGrid coveringGrid(const GroundRect& extent, double spacing, const SquareGrid* anchor) {
    TERRAY_CHECK_OP(spacing, >, 0);
    SquareGrid grid{.west = extent.west, .north = extent.north, .spacing = spacing};
    if (anchor != nullptr) {
        grid.west = anchor->west + std::floor((extent.west - anchor->west) / spacing + kRounding) * spacing;
        grid.north = anchor->north - std::floor((anchor->north - extent.north) / spacing + kRounding) * spacing;
    }
    const auto cells = [&](double length) {
        return static_cast<int64_t>(std::clamp(std::ceil(length / spacing - kRounding), 1.0, kMostCells));
    };
    grid.size = {cells(extent.east - grid.west), cells(grid.north - extent.south)};
    return grid;
}

std::optional<SquareGrid> clippedGrid(const SquareGrid& grid, const GroundRect& area) {
    // Of cells along one axis from its start, as distances in cells: those between `from` and `to`.
    const auto first = [](double from, int64_t cells) {
        return static_cast<int64_t>(std::clamp(std::floor(from + kRounding), 0.0, static_cast<double>(cells)));
    };
    const auto last = [](double to, int64_t cells) {
        return static_cast<int64_t>(std::clamp(std::ceil(to - kRounding), 0.0, static_cast<double>(cells)));
    };
    const int64_t left = first((area.west - grid.west) / grid.spacing, grid.size.width);
    const int64_t right = last((area.east - grid.west) / grid.spacing, grid.size.width);
    const int64_t top = first((grid.north - area.north) / grid.spacing, grid.size.height);
    const int64_t bottom = last((grid.north - area.south) / grid.spacing, grid.size.height);
    if (left >= right || top >= bottom) return {};
    return SquareGrid{.west = grid.west + static_cast<double>(left) * grid.spacing,
                      .north = grid.north - static_cast<double>(top) * grid.spacing,
                      .spacing = grid.spacing,
                      .size = {right - left, bottom - top}};
}

GroundRect unionOf(const GroundRect& a, const GroundRect& b) {
    return {std::min(a.west, b.west), std::min(a.south, b.south), std::max(a.east, b.east), std::max(a.north, b.north)};
}

std::optional<GroundRect> overlapOf(const GroundRect& a, const GroundRect& b) {
    const GroundRect common{std::max(a.west, b.west), std::max(a.south, b.south), std::min(a.east, b.east),
                            std::min(a.north, b.north)};
    if (common.west >= common.east || common.south >= common.north) return {};
    return common;
}

uint32_t imageryLevelFor(double photoSpacing, const Tiling& tiling) {
    uint32_t level = 0;
    while (level < kMaxTileLevel && tiling.spacing(level) > 1.2 * photoSpacing) ++level;
    return level;
}

GridRect imageryCells(const GroundRect& area, const Tiling& tiling, uint32_t level) {
    const double spacing = tiling.spacing(level);
    const auto first = [&](double distance) { return std::llround(std::floor(distance / spacing + kRounding)); };
    const auto last = [&](double distance) { return std::llround(std::ceil(distance / spacing - kRounding)); };
    const int64_t left = first(area.west - tiling.west);
    const int64_t top = first(tiling.north - area.north);
    return {left, top, last(area.east - tiling.west) - left, last(tiling.north - area.south) - top};
}

std::optional<double> metresPerHeightUnit(std::string unit) {
    static constexpr std::array<std::pair<const char*, double>, 22> kUnits{{
        {"m", 1},
        {"metre", 1},
        {"metres", 1},
        {"meter", 1},
        {"meters", 1},
        {"ft", 0.3048},
        {"foot", 0.3048},
        {"feet", 0.3048},
        {"international foot", 0.3048},
        {"us-ft", 1200.0 / 3937},
        {"ftus", 1200.0 / 3937},
        {"us survey foot", 1200.0 / 3937},
        {"us survey feet", 1200.0 / 3937},
        {"foot_us", 1200.0 / 3937},
        {"sfoot", 1200.0 / 3937},
        {"km", 1000},
        {"kilometre", 1000},
        {"kilometer", 1000},
        {"dm", 0.1},
        {"decimetre", 0.1},
        {"cm", 0.01},
        {"mm", 0.001},
    }};
    std::ranges::transform(unit, unit.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const auto* known = std::ranges::find(kUnits, unit, [](const auto& entry) { return std::string(entry.first); });
    if (known == kUnits.end()) return {};
    return known->second;
}

std::string describe(const GroundRect& extent, const std::string& crsName) {
    std::array<char, 160> text{};
    std::snprintf(text.data(), text.size(), "W %.10g, S %.10g, E %.10g, N %.10g", extent.west, extent.south,
                  extent.east, extent.north);
    return std::string(text.data()) + " (metres, " + (crsName.empty() ? "unnamed plane" : crsName) + ")";
}

bool namesDegreeAxes(const std::vector<std::string>& items) {
    bool east = false;
    bool north = false;
    for (const std::string& text : items) {
        const size_t value = text.find("#units=degree");
        if (value == std::string::npos) continue;
        east = east || text.find("_e", value) != std::string::npos || text.find("_E", value) != std::string::npos;
        north = north || text.find("_n", value) != std::string::npos || text.find("_N", value) != std::string::npos;
    }
    return east && north;
}

std::optional<SourceFile> fileOnDisk(const std::string& path) {
    struct stat status {};
    if (stat(path.c_str(), &status) != 0) return {};
    return SourceFile{path, static_cast<uint64_t>(status.st_size), static_cast<int64_t>(status.st_mtime)};
}

}  // namespace terray
