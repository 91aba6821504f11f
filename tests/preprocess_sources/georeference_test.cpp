// From files to tiles: a landmark that heights and photo share lands in the same cell of both, to the texel.

#include <gtest/gtest.h>

#include "common/bc1_decode.h"
#include "common/height_tile.h"
#include "common/imagery_tile.h"
#include "preprocess/dataset_archives.h"
#include "preprocess/dataset_builder.h"
#include "tests/preprocess_sources/raster_writer.h"

namespace terray::test {
namespace {

constexpr double kWest = 500000;
constexpr double kNorth = 5200000;
constexpr double kSpacing = 10;   // metres between heights
constexpr int64_t kTexels = 4;    // of the photo along a cell
constexpr int64_t kColumn = 617;  // of the landmark, a tower with a red roof
constexpr int64_t kRow = 533;
constexpr GridSize kSize{700, 600};
constexpr double kTower = 1234;  // metres

bool isTower(int64_t column, int64_t row) {
    return column == kColumn && row == kRow;
}

/// @param pixelIs  what the files say their positions mean, "Area" or "Point": a GeoTIFF of points gives the position
/// of
///                 its first sample's centre, half a cell inside its corner. GDAL's transform is of corners always.
class Georeference : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        const std::string heights =
            writeRaster((folder_ / "heights.tif").string(),
                        {.size = kSize,
                         .transform = northUp(kWest, kNorth, kSpacing),
                         .crs = "EPSG:32632",
                         .metadata = {{"AREA_OR_POINT", GetParam()}},
                         .value = [](int, int64_t x, int64_t y) { return isTower(x, y) ? kTower : 100.0; }});
        const std::string photo =
            writeRaster((folder_ / "photo.tif").string(),
                        {.size = {kTexels * kSize.width, kTexels * kSize.height},
                         .bands = 3,
                         .type = "Byte",
                         .transform = northUp(kWest, kNorth, kSpacing / kTexels),
                         .crs = "EPSG:32632",
                         .metadata = {{"AREA_OR_POINT", GetParam()}},
                         .value = [](int band, int64_t x, int64_t y) {
                             return (band == 0) == isTower(x / kTexels, y / kTexels) ? 255.0 : 0.0;
                         }});
        const auto source = openGdalHeights({.files = {heights}});
        const OpenPhoto openPhoto = [&](const Tiling& tiling, const HeightGridInfo& info) {
            return openGdalPhotos({.files = {photo}, .cacheBytes = 64u << 20}, tiling, info.size, info.crsWkt);
        };
        (void)buildDataset(*source, openPhoto, {.out = folder_ / "out", .jobs = 2});
    }
    [[nodiscard]] DatasetArchives dataset() const { return openDataset(folder_ / "out"); }

    TemporaryDirectory folder_;
};

TEST_P(Georeference, ATowerStandsInItsOwnCell) {
    const DatasetArchives out = dataset();
    EXPECT_EQ(out.metadata.tiling.west, kWest);
    EXPECT_EQ(out.metadata.tiling.north, kNorth);
    const TileId id{1, kColumn / kTileCore, kRow / kTileCore};
    const HeightTile tile = decodeHeightTile(*out.heights.read(id).value(), id).value();
    for (int64_t row = 500; row < kSize.height; ++row)
        for (int64_t column = 500; column < kSize.width; ++column) {
            const int64_t x = column - kTileCore + kHeightApron;
            const int64_t y = row - kTileCore + kHeightApron;
            if (x < 0 || y < 0) continue;
            ASSERT_NEAR(tile.encoding.height(tile.codes.at(x, y)), isTower(column, row) ? kTower : 100, 0.005)
                << column << ", " << row;
        }
}

TEST_P(Georeference, TheRoofLiesOnItsTower) {
    const DatasetArchives out = dataset();
    ASSERT_EQ(out.metadata.imageryLevel, 3u);  // two levels finer than the heights: 2.5 m
    const auto column = static_cast<uint32_t>(kColumn * kTexels);
    const auto row = static_cast<uint32_t>(kRow * kTexels);
    const TileId id{3, column / kTileCore, row / kTileCore};
    const ImageryTile tile = decodeImageryTile(*out.imagery->read(id).value(), id).value();
    const Grid<Rgba> texels = decodeBc1(tile.mip(0), {imageryMipSide(0), imageryMipSide(0)});
    for (int64_t y = 0; y < texels.height(); ++y)
        for (int64_t x = 0; x < texels.width(); ++x) {
            const int64_t photoX = x - kImageryGutter + int64_t{id.x} * kTileCore;
            const int64_t photoY = y - kImageryGutter + int64_t{id.y} * kTileCore;
            if (photoX >= kTexels * kSize.width || photoY >= kTexels * kSize.height) continue;
            const bool isRoof = isTower(photoX / kTexels, photoY / kTexels);
            ASSERT_EQ(texels.at(x, y), (isRoof ? Rgba{255, 0, 0, 255} : Rgba{0, 255, 255, 255})) << x << ", " << y;
        }
}

INSTANTIATE_TEST_SUITE_P(PixelIs, Georeference, testing::Values("Area", "Point"),
                         [](const auto& instance) { return std::string(instance.param); });

}  // namespace
}  // namespace terray::test
