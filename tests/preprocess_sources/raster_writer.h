#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/error.h"
#include "common/geodesy.h"
#include "preprocess/raster_files.h"
#include "preprocess/raster_layout.h"
#include "tests/common/temporary_directory.h"

namespace terray::test {

/// What is to be written, by GDAL.
struct RasterSpec {
    GridSize size{8, 8};
    int bands = 1;
    std::string type = "Float32";  ///< as GDAL names it
    std::string driver = "GTiff";
    std::optional<GeoTransform> transform;
    std::string crs;  ///< "EPSG:32632"; empty: none
    std::optional<double> nodata;
    double scale = 1;
    double offset = 0;
    std::string unit;
    bool lastBandIsAlpha = false;
    std::vector<std::array<int, 3>> palette;
    std::vector<std::pair<std::string, std::string>> metadata;
    std::vector<std::string> creationOptions;
    /// Sample of (band from 0, column, row), in stored units.
    std::function<double(int, int64_t, int64_t)> value = [](int, int64_t, int64_t) { return 0.0; };
};

/// A transform of square cells, north up.
[[nodiscard]] GeoTransform northUp(double west, double north, double spacing);

/// Writes it to `file` and returns `file`.
std::string writeRaster(const std::string& file, const RasterSpec& spec);

/// Longitude and latitude of a place, by PROJ through GDAL.
[[nodiscard]] LonLat lonLatOf(const std::string& crs, double x, double y);
/// The place of a longitude and latitude.
[[nodiscard]] std::pair<double, double> placeOf(const std::string& crs, LonLat lonLat);

/// All of a source, in one window that reaches `margin` samples beyond it on each side.
[[nodiscard]] Grid<float> readAll(const HeightSource& source, int64_t margin = 0);

/// Some cells of a photo's imagery level.
[[nodiscard]] Grid<Rgba> readCells(const ColourSource& source, const GridRect& window);

/// The exit code and message of the Error that `action` throws; code ok when it throws none.
struct Refusal {
    ExitCode code = ExitCode::ok;
    std::string message;
    [[nodiscard]] bool says(const std::string& text) const { return message.find(text) != std::string::npos; }
};
[[nodiscard]] Refusal refusalOf(const std::function<void()>& action);

}  // namespace terray::test
