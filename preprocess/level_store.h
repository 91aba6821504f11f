#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "common/grid.h"
#include "preprocess/work_file.h"

namespace terray {

/// The samples of one level between two stages of the build: written tile by tile by the stage below, read in windows
/// with margins by the stage above.
///
/// A sample is `planes` floats (heights: mean, lowest, highest; photos: red, green, blue, coverage), so a tile takes
/// 512 x 512 x planes x 4 bytes of a temporary file; tiles not taken take no space and read as `fill`. Any thread
/// may write a tile of its own; reading begins when all writing has ended.
class LevelStore {
  public:
    /// Opens the file as an earlier run left it, or creates it.
    /// @param tiles  columns and rows of the level's tiles that may be written
    LevelStore(const std::filesystem::path& path, const GridRect& tiles, int planes, float fill);

    /// Stores a tile's core: one kTileCore x kTileCore view for each plane.
    void write(int64_t tileX, int64_t tileY, std::span<const GridView<const float>> planes);
    /// Counts a tile as there: once it is written, in this run or an earlier one.
    void take(int64_t tileX, int64_t tileY) { written_.at(tileX - tiles_.x, tileY - tiles_.y) = 1; }
    /// Of any tile, also one that may not be written.
    [[nodiscard]] bool has(int64_t tileX, int64_t tileY) const;
    /// One plane of `window`, in samples of the level; beyond the level and in tiles not written: `fill`.
    void read(const GridRect& window, int plane, GridView<float> out) const;
    [[nodiscard]] WorkFile& file() { return file_; }

  private:
    [[nodiscard]] uint64_t rowOffset(int64_t tileX, int64_t tileY, int plane, int64_t row) const;

    GridRect tiles_;
    int planes_;
    float fill_;
    WorkFile file_;
    Grid<uint8_t> written_;
};

}  // namespace terray
