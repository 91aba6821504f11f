#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/geodesy.h"
#include "preprocess/raster_layout.h"
#include "preprocess/raster_source.h"

// The door to GDAL: everything Terray asks of it, in plain values. gdal_door.h and the sources gdal_raster.cpp,
// gdal_reader.cpp and gdal_vertical.cpp are the only files that include GDAL.
// Nothing that GDAL says reaches the terminal; it becomes part of an Error, or of RasterFacts::warnings.

namespace terray::gdal {

/// What a raster says of itself.
struct RasterFacts {
    std::string name;                          ///< what GDAL opens: the file, or the one grid inside it
    GridSize size;                             ///< both > 0
    std::optional<GeoTransform> geoTransform;  ///< none: the file does not say where it lies
    bool isPlacedHere = false;                 ///< geoTransform was given by Terray: GDAL has to be told
    Crs crs;                                   ///< wkt is empty when the file names none
    std::vector<int> colourBands;              ///< numbers of red, green, blue; of one grey band three times
    int bands = 1;
    GridSize block;           ///< pixels that are stored, and so read, together: a tile, or a strip as wide as the file
    uint64_t pixelBytes = 0;  ///< of all bands, unpacked
    bool isInteger = false;   ///< type of the first band, as are the following
    int bits = 32;            ///< of a sample that count, such as 12 of 16
    bool hasPalette = false;
    std::optional<std::array<double, 3>> colourNodata;  ///< of the colour bands, when each declares one
    std::optional<double> nodata;                       ///< in stored units
    double scale = 1;                                   ///< height = stored * scale + offset, in `unit`
    double offset = 0;
    std::string unit;  ///< as the file writes it
    std::vector<SourceFile> files;
    std::vector<std::string> warnings;  ///< what GDAL said while opening
};

/// Bounds the memory of GDAL's block cache, which all rasters share.
void limitCache(uint64_t bytes);

/// Opens a raster and looks at it. Of a container with several grids, the only one with a single band is taken. Throws
/// Error(input) saying whether the file is missing, empty, no raster, or holds several grids (with their names).
[[nodiscard]] RasterFacts inspect(const std::string& file);

/// A coordinate system from "EPSG:2056", WKT or PROJ text. Throws Error(georeference) for what is none.
[[nodiscard]] Crs describeCrs(const std::string& text);
/// Whether both mean the same horizontal system, however they are written.
[[nodiscard]] bool sameCrs(const Crs& a, const Crs& b);

/// A raster that GDAL derives from others while it is read (VRT), described by a file in memory that lives as long as
/// this. Any number of threads may open name().
class VirtualRaster {
  public:
    [[nodiscard]] const std::string& name() const { return *name_; }

  private:
    friend VirtualRaster translate(const std::string& source, const std::vector<std::string>& options);
    friend VirtualRaster mosaic(const std::vector<std::string>& sources, const std::vector<std::string>& options);
    friend VirtualRaster warp(const std::string& source, const std::vector<std::string>& options);
    VirtualRaster();
    std::shared_ptr<const std::string> name_;  ///< the last owner's end removes the file
};

/// One raster with other bands, types or labels. `options` are those of gdal_translate.
[[nodiscard]] VirtualRaster translate(const std::string& source, const std::vector<std::string>& options);
/// Describes another raster under the name of an earlier translate(); who has that name open does not notice.
void describeAnew(const VirtualRaster& target, const std::string& source, const std::vector<std::string>& options);
/// Rasters of one system and one grid side by side, later ones on top. `options` are those of gdalbuildvrt.
[[nodiscard]] VirtualRaster mosaic(const std::vector<std::string>& sources, const std::vector<std::string>& options);
/// A raster resampled to another system and grid. `options` are those of gdalwarp.
[[nodiscard]] VirtualRaster warp(const std::string& source, const std::vector<std::string>& options);

/// Where a raster lies in another system. Empty `crsWkt`: in its own plane. Throws Error(georeference) when it cannot
/// be transformed there.
struct Footprint {
    GroundRect extent;  ///< of the outline, metres
    double finestSpacing =
        0;  ///< metres at the raster's centre: the lesser of a step along its rows and along its columns
};
[[nodiscard]] Footprint footprint(const std::string& raster, const std::string& crsWkt);

/// Centre of a raster that has a coordinate system. Throws Error(georeference) when it has no longitude and latitude.
[[nodiscard]] LonLat centre(const std::string& raster);
/// Longitudes and latitudes (WGS 84, degrees) that an area covers; west > east across the antimeridian. Empty when
/// unknown.
[[nodiscard]] std::optional<GroundRect> lonLatBounds(const GroundRect& area, const std::string& crsWkt);

/// Gives each hole (NaN) up to `distance` cells from a height one that is interpolated from heights around it, weighted
/// by inverse distance (GDALFillNodata, no smoothing). A cell depends on those within `distance` along either axis
/// alone.
void fillHoles(Grid<float>& heights, int distance);

/// Rows that copyInTiles() reads at a time: what limitCache() leaves room for, from 16 to 256.
[[nodiscard]] int64_t rowsOfCopy(GridSize size);
/// Copies a raster of one band of floats, or of four of bytes, with all that it says of itself, to a TIFF that is cut
/// into small tiles and packed without loss. Reads it once, in whole rows from the top, and calls `rowsDone` after
/// every rowsOfCopy() of them; what that throws ends the copy. Throws Error(input) when the raster cannot be read,
/// Error(output) when the copy cannot be written.
void copyInTiles(const std::string& raster, const std::string& label, const std::string& file,
                 const std::function<void()>& rowsDone);

/// Reads one raster. Opened by the first read, since GDAL ties some handles to the thread that opens them. For one
/// thread.
class RasterReader {
  public:
    /// @param label  the raster's name in messages
    RasterReader(std::string name, std::string label);
    ~RasterReader();
    RasterReader(RasterReader&&) noexcept;

    /// The first band's samples as they are stored; NaN where the file's own mask hides them. `window` lies inside the
    /// raster and has the size of `out`. Throws Error(input) on any read error, so also when a file is cut short.
    void read(const GridRect& window, GridView<float> out);
    /// Four bands of bytes.
    void read(const GridRect& window, GridView<Rgba> out);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace terray::gdal
