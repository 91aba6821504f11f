#pragma once

#include <string>
#include <vector>

#include "preprocess/gdal_raster.h"

namespace terray {

/// Files of a source that are stored in rows (one strip a row, or a PNG), and copies of them that are cut into tiles.
///
/// A block of the build is a square. Out of rows that are many blocks wide it would be read by unpacking the rows
/// whole, once for every block along them. So each such file is copied once, from its first row to its last, when the
/// build begins, and blocks are read from the copy.
class TiledCopies {
  public:
    /// @param cacheBytes  of the reading library: a file that fits half of it stays there and needs no copy
    explicit TiledCopies(uint64_t cacheBytes) : cacheBytes_(cacheBytes) {}

    /// The name by which to read `derived`, made of the file that `facts` tell of (one band of floats, or four of
    /// bytes): its own name, or one that means a copy of it from prepare() on.
    [[nodiscard]] std::string nameOf(const gdal::VirtualRaster& derived, const gdal::RasterFacts& facts);

    /// As HeightSource::preparedBytes() and prepare().
    [[nodiscard]] uint64_t bytes() const;
    void prepare(const SourceWorkspace& workspace) const;

  private:
    struct Copy {
        gdal::VirtualRaster original;
        gdal::VirtualRaster alias;  ///< means the original until there is a copy
        std::string label;
        GridSize size;
    };
    void make(const Copy& copy, const std::filesystem::path& file, const SourceWorkspace& workspace) const;

    uint64_t cacheBytes_;
    std::vector<Copy> copies_;
};

}  // namespace terray
