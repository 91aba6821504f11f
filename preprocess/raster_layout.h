#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/dataset_metadata.h"
#include "common/grid.h"
#include "common/tiling.h"

// Where rasters lie and on which grid to read them: decisions that need no raster library.

namespace terray {

/// Ground from pixel: x = t[0] + column t[1] + row t[2], y = t[3] + column t[4] + row t[5], pixel corners being whole
/// numbers.
using GeoTransform = std::array<double, 6>;

/// A coordinate system, as far as choosing a grid needs it.
struct Crs {
    std::string wkt;   ///< WKT2 of the horizontal part; empty: an unnamed plane in metres
    std::string name;  ///< "EPSG:32613", or the system's own name
    std::string verticalDatum = "unknown";
    std::string verticalUnit;  ///< of a compound system, as it names it
    std::string verticalWkt;   ///< of a compound system's vertical part
    bool isProjected = false;  ///< a plane: neither degrees nor geocentric
    double metresPerUnit = 1;  ///< of a plane's coordinates

    /// Whether a dataset can lie in it: a plane measured in metres.
    [[nodiscard]] bool isMetric() const { return wkt.empty() || (isProjected && metresPerUnit == 1); }
};

/// A place in a raster, in pixels from its upper-left corner.
struct PixelPlace {
    double x = 0;
    double y = 0;
};

/// Pixels all over a raster, and densely along its outline, which another system bends: between two of them an arc that
/// turns by 60 degrees in all bulges by 1e-5 of its length.
[[nodiscard]] std::vector<PixelPlace> outlinePixels(GridSize size);

/// Square cells, the upper-left corner of the first at (west, north).
struct SquareGrid {
    double west = 0;     ///< metres
    double north = 0;    ///< metres
    double spacing = 1;  ///< metres, > 0
    GridSize size;

    [[nodiscard]] GroundRect bounds() const;
};

/// The grid of a north-up raster with square cells, sides equal to 1 part in 10^6 (a drift of a tenth of a cell over
/// 100,000); none for others, which must be warped.
[[nodiscard]] std::optional<SquareGrid> squareGrid(const GeoTransform& transform, GridSize size);

/// Whether rows run to the east and columns to the south, so that rasters can be laid side by side without resampling.
[[nodiscard]] bool isNorthUp(const GeoTransform& transform);

/// Whether samples of both are samples of one common grid: same cell sides (1 part in 10^6), and corners a whole number
/// of cells apart to a hundredth of a cell. Both must be north-up.
[[nodiscard]] bool shareGrid(const GeoTransform& a, const GeoTransform& b);

/// The least grid that covers `extent`; its lines go through the anchor's when there is one, else through the extent's
/// upper-left corner. Overhangs below a millionth of a cell count as rounding and add no cell. A side has at most 10^15
/// cells; who needs fewer must check.
[[nodiscard]] SquareGrid coveringGrid(const GroundRect& extent, double spacing, const SquareGrid* anchor);

/// The part of a grid whose cells touch `area` by more than a millionth of a cell; none when no cell does.
[[nodiscard]] std::optional<SquareGrid> clippedGrid(const SquareGrid& grid, const GroundRect& area);

/// The area that holds both.
[[nodiscard]] GroundRect unionOf(const GroundRect& a, const GroundRect& b);
/// The area common to both, if there is any.
[[nodiscard]] std::optional<GroundRect> overlapOf(const GroundRect& a, const GroundRect& b);

/// The level of `tiling` at which a photo of this resolution (metres) is kept: the coarsest whose texels are at
/// most 1.2 times the photo's, 0 at the least.
[[nodiscard]] uint32_t imageryLevelFor(double photoSpacing, const Tiling& tiling);
/// Cells of an imagery level, anchored at the root square's corner, that touch `area`.
[[nodiscard]] GridRect imageryCells(const GroundRect& area, const Tiling& tiling, uint32_t level);

/// Metres in a unit of height as files write it ("m", "feet", "us-ft", "km"); none for an unknown or empty one.
[[nodiscard]] std::optional<double> metresPerHeightUnit(std::string unit);

/// Whether metadata items ("x#units=degrees_east") name both axes in degrees: netCDF files often leave their coordinate
/// system unsaid but measure their axes so, as the CF conventions define.
[[nodiscard]] bool namesDegreeAxes(const std::vector<std::string>& items);

/// Size and time of a file; none when it is not there (as the parts of a virtual file system are not).
[[nodiscard]] std::optional<SourceFile> fileOnDisk(const std::string& path);

/// "W 557805, S 5107995, E 567615, N 5122035 (metres, EPSG:26710)", for messages.
[[nodiscard]] std::string describe(const GroundRect& extent, const std::string& crsName);

}  // namespace terray
