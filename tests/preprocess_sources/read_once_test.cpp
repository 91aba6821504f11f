// A build reads its input about once, however the files are stored: counted between GDAL and the files.

#include <cstdlib>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "preprocess/dataset_archives.h"
#include "preprocess/dataset_builder.h"
#include "tests/preprocess_sources/raster_writer.h"
#include "tests/preprocess_sources/read_counter.h"

namespace terray::test {
namespace {

/// Five blocks wide, so that rows would be read five times.
constexpr GridSize kSize{4200, 600};
constexpr uint64_t kCacheBytes = 2u << 20;  // holds a fifth of the DEM
constexpr double kMostReads = 1.3;          // bytes read for each byte of the files

double heightAt(int64_t x, int64_t y) {
    return x > 2000 && x < 2100 && y > 480 && y < 560 ? -9999.0 : static_cast<double>((x * x / 50 + 7 * y) % 3000);
}

RasterSpec dem(std::vector<std::string> storage) {
    return {.size = kSize,
            .type = "Int16",
            .transform = northUp(500000, 5200000, 10),
            .crs = "EPSG:32632",
            .nodata = -9999,
            .creationOptions = std::move(storage),
            .value = [](int, int64_t x, int64_t y) { return heightAt(x, y); }};
}

RasterSpec photo(std::vector<std::string> storage, const std::string& driver = "GTiff") {
    return {.size = kSize,
            .bands = 3,
            .type = "Byte",
            .driver = driver,
            .transform = northUp(500000, 5200000, 10),
            .crs = "EPSG:32632",
            .creationOptions = std::move(storage),
            .value = [](int band, int64_t x, int64_t y) {
                // Rough, so that no compression makes the file so small that opening it counts.
                return static_cast<double>((x / 3 + y / 5 * (band + 1) + x * y * y % 97) % 251);
            }};
}

class ReadOnce : public testing::Test {
  protected:
    /// Builds "out" of a DEM and, if named, a photo. @return bytes read for each byte of the counted files
    double build(const std::string& heightFile, const std::string& photoFile, uint64_t countedBytes,
                 const std::string& crs = "") {
        (void)takeBytesRead();
        const auto heights = openGdalHeights({.files = {heightFile}, .crs = crs, .cacheBytes = kCacheBytes});
        OpenPhoto openPhoto;
        if (!photoFile.empty())
            openPhoto = [&](const Tiling& tiling, const HeightGridInfo& info) {
                return openGdalPhotos({.files = {photoFile}, .cacheBytes = kCacheBytes}, tiling, info.size,
                                      info.crsWkt);
            };
        (void)buildDataset(*heights, openPhoto, {.out = folder_ / "out", .replace = true, .jobs = 2, .blockDepth = 1});
        const double reads = static_cast<double>(takeBytesRead()) / static_cast<double>(countedBytes);
        RecordProperty("bytesReadForEachByte", std::to_string(reads));
        return reads;
    }
    [[nodiscard]] std::string write(const std::string& name, const RasterSpec& spec) const {
        return writeRaster((folder_ / name).string(), spec);
    }
    /// All tiles of an archive of "out", one after the other; what the metadata say of the sources is not among them.
    [[nodiscard]] Bytes tiles(bool ofHeights) const {
        const DatasetArchives dataset = openDataset(folder_ / "out");
        const PmtilesReader& archive = ofHeights ? dataset.heights : *dataset.imagery;
        Bytes all;
        EXPECT_TRUE(archive
                        .forEach([&](const TileId& id, uint64_t, uint32_t) {
                            const Bytes payload = archive.read(id).value().value();
                            all.insert(all.end(), payload.begin(), payload.end());
                        })
                        .ok());
        return all;
    }

    TemporaryDirectory folder_;
};

uint64_t bytesOf(const std::string& file) {
    return std::filesystem::file_size(file);
}

TEST_F(ReadOnce, AWideDemInStrips) {
    const std::string strips = write("strips.tif", dem({"BLOCKYSIZE=1"}));
    EXPECT_LE(build(countedName(strips), "", bytesOf(strips)), kMostReads);
    const Bytes fromStrips = tiles(true);
    (void)build(write("tiles.tif", dem({"TILED=YES"})), "", 1);
    EXPECT_TRUE(fromStrips == tiles(true)) << "heights differ from those of the same DEM in tiles";
}

TEST_F(ReadOnce, AWideDemInStripsThatIsWarped) {
    const std::string strips = write("strips.tif", dem({"BLOCKYSIZE=1", "COMPRESS=DEFLATE"}));
    EXPECT_LE(build(countedName(strips), "", bytesOf(strips), "EPSG:32633"), kMostReads);
}

TEST_F(ReadOnce, AWideDemInStripsBehindAVrt) {
    const std::string strips = write("strips.tif", dem({"BLOCKYSIZE=1"}));
    const std::string vrt = (folder_ / "dem.vrt").string();
    ASSERT_EQ(std::system(("gdalbuildvrt -q " + vrt + " " + strips).c_str()), 0);
    std::string text;
    {
        std::ifstream in(vrt);
        text.assign(std::istreambuf_iterator<char>(in), {});
    }
    const size_t name = text.find("strips.tif");
    ASSERT_NE(name, std::string::npos);
    text.replace(name, 10, countedName(strips));
    const size_t relative = text.find("relativeToVRT=\"1\"");
    ASSERT_NE(relative, std::string::npos);
    text.replace(relative, 17, "relativeToVRT=\"0\"");
    std::ofstream(vrt) << text;
    EXPECT_LE(build(vrt, "", bytesOf(strips)), kMostReads);
}

TEST_F(ReadOnce, WidePlainImagesGoTheSameWay) {
    RasterSpec plain = dem({});
    plain.driver = "PNG";
    plain.type = "UInt16";
    plain.transform.reset();
    plain.crs.clear();
    const std::string png = write("plain.png", plain);
    EXPECT_TRUE(isStoredInWideRows(png, kCacheBytes));
    EXPECT_FALSE(isStoredInWideRows(png, 64u << 20)) << "the cache holds all of it";
    EXPECT_FALSE(isStoredInWideRows("/nowhere.png", kCacheBytes));
}

#if TERRAY_WITH_STB
TEST_F(ReadOnce, AWidePhotoInStrips) {
    const std::string heights = write("dem.tif", dem({"TILED=YES"}));
    const std::string strips = write("photo.tif", photo({"BLOCKYSIZE=1", "COMPRESS=DEFLATE"}));
    EXPECT_LE(build(heights, countedName(strips), bytesOf(strips)), kMostReads);
    const Bytes fromStrips = tiles(false);
    (void)build(heights, write("tiles.tif", photo({"TILED=YES"})), 1);
    EXPECT_TRUE(fromStrips == tiles(false)) << "texels differ from those of the same photo in tiles";
}

TEST_F(ReadOnce, AWidePng) {
    const std::string heights = write("dem.tif", dem({"TILED=YES"}));
    const std::string png = write("photo.png", photo({"WORLDFILE=YES"}, "PNG"));
    EXPECT_LE(build(heights, countedName(png), bytesOf(png)), kMostReads);
}
#endif

}  // namespace
}  // namespace terray::test
