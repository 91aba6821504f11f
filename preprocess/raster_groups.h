#pragma once

#include <string>
#include <vector>

#include "preprocess/gdal_raster.h"
#include "preprocess/raster_layout.h"

// How several files become few rasters, for heights and photos alike.

namespace terray {

/// Files that lie on one grid of one system, so that they can be laid side by side before anything is resampled: then
/// no seam is left where one ends and the next begins.
struct RasterGroup {
    std::vector<size_t> members;  ///< indices of the files, the lowest first
    Crs crs;
    GeoTransform transform{};  ///< of the smallest grid that holds all members
    GridSize size;
    std::string raster;  ///< name of the members laid side by side, once that is done
};

/// Indices of the files from the lowest to the one on top. Resolution is taken at three digits, for degrees along the
/// meridian, so that parts of one product stay together. Each must have its geoTransform.
[[nodiscard]] std::vector<size_t> mosaicOrder(const std::vector<gdal::RasterFacts>& rasters, MosaicPriority priority);

/// Groups files that follow one another in `order` (these only, since later files cover earlier ones). Each must have
/// its geoTransform.
[[nodiscard]] std::vector<RasterGroup> groupByGrid(const std::vector<gdal::RasterFacts>& rasters,
                                                   const std::vector<size_t>& order);

/// A number as text that reads back as the same number.
[[nodiscard]] std::string exactText(double value);

/// gdal_translate's options that give a raster the place and the system it has here.
[[nodiscard]] std::vector<std::string> placeArguments(const gdal::RasterFacts& raster);

/// gdalwarp's options for an exact target: system, outline, columns and rows. Reads no overviews, whose samples are
/// other people's averages. Throws Error(input) for more than 2^31 - 1 columns or rows.
[[nodiscard]] std::vector<std::string> gridArguments(const SquareGrid& grid, const std::string& crsWkt);

}  // namespace terray
