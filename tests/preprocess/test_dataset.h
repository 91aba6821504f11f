#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/height_tile.h"
#include "common/imagery_tile.h"
#include "preprocess/dataset_builder.h"
#include "preprocess/raster_source.h"

namespace terray {

/// A directory of its own that goes with this object.
class TemporaryDirectory {
  public:
    TemporaryDirectory();
    ~TemporaryDirectory();
    TemporaryDirectory(const TemporaryDirectory&) = delete;
    TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    /// Names of what lies in it, sorted.
    [[nodiscard]] std::vector<std::string> names() const;

  private:
    std::filesystem::path path_;
};

/// Heights from an array, corner at (1000, 5000).
class GridHeights final : public HeightSource {
  public:
    explicit GridHeights(Grid<float> heights, double spacing = 1);
    [[nodiscard]] const HeightGridInfo& info() const override { return info_; }
    [[nodiscard]] std::unique_ptr<HeightReader> openReader() const override;

    HeightGridInfo info_;
    Grid<float> heights_;
    /// Called at each read, from any thread; may throw.
    std::function<void()> onRead_;
};

/// A photo from an array of texels of the imagery grid's level, its first texel at the root square's corner.
class GridPhoto final : public ColourSource {
  public:
    GridPhoto(Grid<Rgba> texels, uint32_t level, const Tiling& tiling);
    [[nodiscard]] uint32_t level() const override { return level_; }
    [[nodiscard]] GroundRect bounds() const override { return bounds_; }
    [[nodiscard]] const std::vector<SourceFile>& files() const override { return files_; }
    [[nodiscard]] std::unique_ptr<ColourReader> openReader() const override;

    Grid<Rgba> texels_;

  private:
    uint32_t level_;
    GroundRect bounds_;
    std::vector<SourceFile> files_;
};

/// An array filled by a function of column and row.
[[nodiscard]] Grid<float> makeHeights(GridSize size, const std::function<double(int64_t x, int64_t y)>& height);
/// Smooth hills with single-sample noise, from a seed; `holes` of 1000 samples are nodata.
[[nodiscard]] Grid<float> makeHills(GridSize size, uint64_t seed, int holes);

/// How an array is made into a dataset.
struct TestBuild {
    int jobs = 1;
    uint32_t depth = 1;
    std::optional<double> quantum;
};
[[nodiscard]] BuildSummary buildTestDataset(const HeightSource& heights, const std::filesystem::path& out,
                                            const TestBuild& build = {}, const OpenPhoto& openPhoto = {});
/// A photo for buildTestDataset(): `texels` of level `level`.
[[nodiscard]] OpenPhoto gridPhoto(Grid<Rgba> texels, uint32_t level);

/// All tiles of a dataset's archive; fails the test when one cannot be read.
[[nodiscard]] std::map<TileId, HeightTile> readHeightTiles(const std::filesystem::path& dataset);
[[nodiscard]] std::map<TileId, ImageryTile> readImageryTiles(const std::filesystem::path& dataset);

/// The payloads of an archive, by id.
using Payloads = std::map<TileId, Bytes>;
/// Writes an archive of a dataset anew with other payloads or metadata, all else as it was.
void rewriteArchive(const std::filesystem::path& archive,
                    const std::function<void(Payloads&, std::string& metadata)>& edit);

[[nodiscard]] Bytes readFile(const std::filesystem::path& path);
void writeFile(const std::filesystem::path& path, ByteView bytes);

}  // namespace terray
