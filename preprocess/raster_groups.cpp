#include "preprocess/raster_groups.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>

#include "common/check.h"
#include "common/error.h"

namespace terray {

namespace {

bool fits(const RasterGroup& group, const gdal::RasterFacts& raster) {
    return isNorthUp(group.transform) && isNorthUp(*raster.geoTransform) &&
           shareGrid(group.transform, *raster.geoTransform) && gdal::sameCrs(group.crs, raster.crs);
}

void add(RasterGroup& group, size_t index, const gdal::RasterFacts& raster) {
    const GeoTransform& own = *raster.geoTransform;
    GeoTransform& all = group.transform;
    const double east = std::max(all[0] + static_cast<double>(group.size.width) * all[1],
                                 own[0] + static_cast<double>(raster.size.width) * own[1]);
    const double south = std::min(all[3] + static_cast<double>(group.size.height) * all[5],
                                  own[3] + static_cast<double>(raster.size.height) * own[5]);
    all[0] = std::min(all[0], own[0]);
    all[3] = std::max(all[3], own[3]);
    group.size = {std::llround((east - all[0]) / all[1]), std::llround((south - all[3]) / all[5])};
    group.members.push_back(index);
}

/// Metres from one row to the next, of degrees along the meridian, to three digits.
double groundSpacing(const gdal::RasterFacts& raster) {
    constexpr double kMetresPerDegree = 111195;  // of a sphere of 6371 km
    const GeoTransform& transform = *raster.geoTransform;
    const bool isDegrees = !raster.crs.wkt.empty() && !raster.crs.isProjected;
    const double metres =
        std::hypot(transform[2], transform[5]) * (isDegrees ? kMetresPerDegree : raster.crs.metresPerUnit);
    const double unit = std::pow(10, std::floor(std::log10(metres)) - 2);
    return std::round(metres / unit) * unit;
}

}  // namespace

std::vector<size_t> mosaicOrder(const std::vector<gdal::RasterFacts>& rasters, MosaicPriority priority) {
    std::vector<size_t> order(rasters.size());
    std::iota(order.begin(), order.end(), size_t{0});
    if (priority == MosaicPriority::order) return order;
    std::vector<double> spacings;
    std::ranges::transform(rasters, std::back_inserter(spacings), groundSpacing);
    std::ranges::stable_sort(order, std::greater(), [&](size_t index) { return spacings[index]; });
    return order;
}

std::vector<RasterGroup> groupByGrid(const std::vector<gdal::RasterFacts>& rasters, const std::vector<size_t>& order) {
    std::vector<RasterGroup> groups;
    for (const size_t i : order) {
        const gdal::RasterFacts& raster = rasters[i];
        TERRAY_CHECK(raster.geoTransform.has_value());
        if (!groups.empty() && fits(groups.back(), raster))
            add(groups.back(), i, raster);
        else
            groups.push_back(
                {.members = {i}, .crs = raster.crs, .transform = *raster.geoTransform, .size = raster.size});
    }
    return groups;
}

std::string exactText(double value) {
    if (std::isnan(value)) return "nan";
    std::array<char, 40> text{};
    std::snprintf(text.data(), text.size(), "%.17g", value);
    return text.data();
}

std::vector<std::string> placeArguments(const gdal::RasterFacts& raster) {
    std::vector<std::string> arguments;
    const GeoTransform& transform = *raster.geoTransform;
    if (raster.isPlacedHere)
        arguments = {"-a_ullr", exactText(transform[0]), exactText(transform[3]),
                     exactText(transform[0] + static_cast<double>(raster.size.width) * transform[1]),
                     exactText(transform[3] + static_cast<double>(raster.size.height) * transform[5])};
    if (!raster.crs.wkt.empty()) arguments.insert(arguments.end(), {"-a_srs", raster.crs.wkt});
    return arguments;
}

std::vector<std::string> gridArguments(const SquareGrid& grid, const std::string& crsWkt) {
    // GDAL would read a greater number modulo 2^32 and make a raster of some other size.
    constexpr int64_t kMostSide = std::numeric_limits<int>::max();
    if (grid.size.width > kMostSide || grid.size.height > kMostSide)
        throw Error(ExitCode::input, "cannot resample to " + std::to_string(grid.size.width) + " x " +
                                         std::to_string(grid.size.height) + " cells: GDAL takes at most " +
                                         std::to_string(kMostSide) +
                                         " along a side; choose a coarser --spacing, or coarser imagery");
    const GroundRect area = grid.bounds();
    std::vector<std::string> arguments{"-te",
                                       exactText(area.west),
                                       exactText(area.south),
                                       exactText(area.east),
                                       exactText(area.north),
                                       "-ts",
                                       std::to_string(grid.size.width),
                                       std::to_string(grid.size.height),
                                       "-ovr",
                                       "NONE"};
    if (!crsWkt.empty()) arguments.insert(arguments.end(), {"-t_srs", crsWkt});
    return arguments;
}

}  // namespace terray
