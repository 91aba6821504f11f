#pragma once

#include <memory>
#include <string>
#include <vector>

#include "preprocess/raster_layout.h"
#include "preprocess/raster_source.h"

namespace terray {

// The doors to files. Each is compiled from one source file that alone sees its library; built without it, the function
// throws Error(unsupported) naming the library and the configure option.

/// Georeferenced rasters through GDAL: one file, or several mosaicked, the finest on top, or as `priority` says.
///
/// Degrees, rotated grids, non-square cells, or a `crs` other than the source's are warped on the fly (bilinear, on a
/// grid whose spacing is the source's finest on the ground unless `spacing` says otherwise); otherwise samples are
/// taken as they are. With `bounds` the grid ends with the cells that touch these. Fails with Error(input) for what is
/// missing, no raster, cut short or empty, Error(georeference) for a system that is missing or unusable.
[[nodiscard]] std::unique_ptr<HeightSource> openGdalHeights(const HeightSourceOptions& options);

/// A plain height image (PNG, TIFF, EXR) through OpenImageIO: first channel, `spacing` metres per pixel, corner at (0,
/// 0). Integer samples are taken as they are stored (0..65535), not normalised.
[[nodiscard]] std::unique_ptr<HeightSource> openImageHeights(const HeightSourceOptions& options);

/// Whether `file` is to be read as a plain image: OpenImageIO knows it and GDAL finds no georeference in it.
[[nodiscard]] bool isPlainImage(const std::string& file);

/// Whether GDAL opens `file` and finds it stored in rows so wide, and so many, that reading blocks out of it would read
/// it again and again: openGdalHeights() copies such a file once. False without GDAL.
[[nodiscard]] bool isStoredInWideRows(const std::string& file, uint64_t cacheBytes);

/// Photos through GDAL, mosaicked (the finest on top, or as `priority` says) and warped to the imagery grid of
/// `tiling`. Grey, RGB, RGBA, paletted, 8 or 16 bits. A photo without georeference is stretched over the ground of the
/// heights when these are a plain image too. Throws Error(georeference) when no photo overlaps the heights.
[[nodiscard]] std::unique_ptr<ColourSource> openGdalPhotos(const PhotoSourceOptions& options, const Tiling& tiling,
                                                           GridSize samples, const std::string& crsWkt);

/// What to add to heights to measure them in another vertical system, from place to place, by PROJ. For one thread.
class VerticalShift {
  public:
    virtual ~VerticalShift() = default;
    /// Metres to add at places of the dataset's plane. Throws Error(georeference) where it is not defined.
    [[nodiscard]] virtual std::vector<double> at(const std::vector<PixelPlace>& places) = 0;
};
/// @param crsWkt   of the dataset's plane
/// @param fromWkt  the vertical system that heights are in now
/// @param to       "EPSG:5773" and the like, or "ellipsoid" for heights above the plane's own ellipsoid
/// Throws Error(georeference) for a system that is unknown or not vertical, and when PROJ lacks a grid that lies
/// between the two: it is never left out in silence.
[[nodiscard]] std::unique_ptr<VerticalShift> openVerticalShift(const std::string& crsWkt, const std::string& fromWkt,
                                                               const std::string& to);
/// The name of a vertical system as openVerticalShift() takes it.
[[nodiscard]] std::string verticalName(const std::string& crs);

/// Gives each hole (NaN) up to `distance` cells from a height one that GDAL interpolates from the heights around it. A
/// cell depends on those within `distance` along either axis alone.
void interpolateHoles(Grid<float>& heights, int distance);

/// A procedural terrain: a ridged fractal with valleys, plains and a lake, the same for the same seed on every machine,
/// and any window of any size of it at the same cost per sample.
struct SyntheticTerrain {
    int64_t size = 1024;  ///< samples along a side
    double spacing = 1;   ///< metres
    uint64_t seed = 1;
};
[[nodiscard]] std::unique_ptr<HeightSource> makeSyntheticHeights(const SyntheticTerrain& terrain);
/// A photo to go with it, coloured by height and slope, with a checked pattern of fields; one level finer than the
/// heights.
[[nodiscard]] std::unique_ptr<ColourSource> makeSyntheticPhoto(const SyntheticTerrain& terrain, const Tiling& tiling);

}  // namespace terray
