#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/dataset_metadata.h"
#include "common/grid.h"
#include "common/rgba.h"
#include "common/tiling.h"

namespace terray {

/// What a height sample holds where there is no surface.
inline constexpr float kNoHeight = std::numeric_limits<float>::quiet_NaN();

/// Where a grid of heights lies. Cells are squares; the first one's upper-left corner is (west, north).
struct HeightGridInfo {
    GridSize size;    ///< samples of the finest level, both > 0
    double west = 0;  ///< metres in the dataset's coordinate system
    double north = 0;
    double spacing = 1;                      ///< metres, > 0
    std::string crsWkt;                      ///< WKT2; empty for a plain image
    std::string crsName;                     ///< "EPSG:32613", or the system's name
    std::optional<GroundRect> lonLatBounds;  ///< degrees
    std::string verticalDatum = "unknown";
    std::string verticalWkt;  ///< of the system that heights are measured in; empty when the sources do not say
    /// Greatest step, metres, between which values of the source can lie: 1 for integers in metres, 0 when unknown
    /// (floats).
    double sourceStep = 0;
    std::vector<SourceFile> files;
};

/// What a source may use while it makes itself ready for a build.
struct SourceWorkspace {
    std::filesystem::path directory;  ///< there; what an earlier run of the same build left in it may be used
    const std::atomic<bool>& stop;    ///< set: end with Error(interrupted) soon
    std::function<void(const std::string& name, uint64_t steps)> partBegins;  ///< told what is done, for people
    std::function<void()> stepDone;
};

/// Reads windows of one grid. One reader serves one thread.
class HeightReader {
  public:
    virtual ~HeightReader() = default;
    /// Heights in metres for `window` of the finest grid, which may reach beyond the grid: kNoHeight there and where
    /// the source has no data. `out` has the window's size. Throws Error(input) when the source cannot be read.
    virtual void read(const GridRect& window, GridView<float> out) = 0;
    /// Whether what it reads is resampled on the way.
    [[nodiscard]] virtual bool resamples() const { return false; }
};

/// A source of heights of any size: GDAL rasters, plain images, or a procedure. Thread-safe.
class HeightSource {
  public:
    virtual ~HeightSource() = default;
    [[nodiscard]] virtual const HeightGridInfo& info() const = 0;
    [[nodiscard]] virtual std::unique_ptr<HeightReader> openReader() const = 0;
    /// Bytes on the disk that prepare() takes at most.
    [[nodiscard]] virtual uint64_t preparedBytes() const { return 0; }
    /// Makes it cheap to read windows in any order; called while no reader is open. What is made of files in the
    /// workspace is read from then on, so the workspace must outlive all readers that are opened later.
    virtual void prepare(const SourceWorkspace&) const {}
};

/// Reads windows of a photo in 8-bit sRGB, alpha 255 where the photo has data, else 0, resampled to the imagery grid:
/// cells of Tiling::spacing(level()), anchored at the root square's upper-left corner. One reader serves one thread.
class ColourReader {
  public:
    virtual ~ColourReader() = default;
    virtual void read(const GridRect& window, GridView<Rgba> out) = 0;
    /// Whether what it reads is resampled on the way.
    [[nodiscard]] virtual bool resamples() const { return false; }
};

class ColourSource {
  public:
    virtual ~ColourSource() = default;
    /// Finest imagery level: that of the ladder's spacings nearest to the photo's own resolution, never coarser than
    /// 1.2 times it.
    [[nodiscard]] virtual uint32_t level() const = 0;
    /// The ground that the photo covers within the dataset.
    [[nodiscard]] virtual GroundRect bounds() const = 0;
    [[nodiscard]] virtual const std::vector<SourceFile>& files() const = 0;
    [[nodiscard]] virtual std::unique_ptr<ColourReader> openReader() const = 0;
    /// As those of HeightSource.
    [[nodiscard]] virtual uint64_t preparedBytes() const { return 0; }
    virtual void prepare(const SourceWorkspace&) const {}
};

/// Which of several files covers the others where they overlap.
enum class MosaicPriority {
    resolution,  ///< the finer one; of equally fine ones the one given later
    order        ///< the one given later
};

/// How a user asked for heights to be read; every field as the option of `terray-preprocess build` of that name.
struct HeightSourceOptions {
    std::vector<std::string> files;
    std::string crs;                    ///< "EPSG:2056" and the like; empty: the source's, or a metric one chosen
    std::optional<double> spacing;      ///< metres; needed for plain images
    std::optional<double> heightScale;  ///< metres per unit of the source; none: as the file says, else 1
    double heightOffset = 0;            ///< metres, added after scaling
    std::optional<double> nodata;       ///< in the source's unit, instead of what the file says
    std::optional<GroundRect> bounds;   ///< metres in the dataset's system: only samples that touch it are taken
    MosaicPriority priority = MosaicPriority::resolution;
    uint64_t cacheBytes = 256u << 20;              ///< for the reading library's own cache
    std::function<void(const std::string&)> note;  ///< told what was decided, such as the chosen system
};

/// How a user asked for photos to be read.
struct PhotoSourceOptions {
    std::vector<std::string> files;
    MosaicPriority priority = MosaicPriority::resolution;
    uint64_t cacheBytes = 256u << 20;  ///< for the reading library's own cache
};

}  // namespace terray
