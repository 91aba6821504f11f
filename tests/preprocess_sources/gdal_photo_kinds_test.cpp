// Kinds of photos: bands, depths, palettes, and what they say about pixels without data.

#include <filesystem>

#include <gtest/gtest.h>

#include "tests/preprocess_sources/raster_writer.h"

namespace terray::test {
namespace {

class PhotoKinds : public testing::Test {
  protected:
    /// The photo's 16 x 16 pixels, as they come out at its own resolution.
    Grid<Rgba> pixelsOf(RasterSpec spec) {
        spec.size = {16, 16};
        spec.transform = northUp(500000, 5200000, 1);
        spec.crs = "EPSG:32632";
        file_ = writeRaster((folder_ / "photo.tif").string(), spec);
        return readCells(*openGdalPhotos({.files = {file_}, .cacheBytes = 1 << 20}, kTiling, {512, 512}, "EPSG:32632"),
                         {0, 0, 16, 16});
    }
    static constexpr Tiling kTiling{.west = 500000, .north = 5200000, .finestSpacing = 1, .finestLevel = 0};
    TemporaryDirectory folder_;
    std::string file_;
};

TEST_F(PhotoKinds, GreyIsRepeated) {
    EXPECT_EQ(pixelsOf({.type = "Byte", .value = [](int, int64_t x, int64_t) { return 10.0 * static_cast<double>(x); }})
                  .at(7, 3),
              (Rgba{70, 70, 70, 255}));
}

TEST_F(PhotoKinds, SixteenBitsAreScaledToEight) {
    const Grid<Rgba> pixels =
        pixelsOf({.bands = 3, .type = "UInt16", .value = [](int band, int64_t, int64_t) {
                      return std::array<double, 3>{65535, 257 * 100, 0}[static_cast<size_t>(band)];
                  }});
    EXPECT_EQ(pixels.at(5, 5), (Rgba{255, 100, 0, 255}));
}

TEST_F(PhotoKinds, TwelveOfSixteenBitsAreScaledByTheirOwnRange) {
    const Grid<Rgba> pixels =
        pixelsOf({.bands = 3, .type = "UInt16", .creationOptions = {"NBITS=12"}, .value = [](int, int64_t, int64_t) {
                      return 4095.0;
                  }});
    EXPECT_EQ(pixels.at(5, 5), (Rgba{255, 255, 255, 255}));
}

TEST_F(PhotoKinds, PalettesAreExpanded) {
    const Grid<Rgba> pixels = pixelsOf({.type = "Byte",
                                        .palette = {{0, 0, 0}, {200, 30, 40}, {20, 40, 250}},
                                        .value = [](int, int64_t x, int64_t) { return x < 8 ? 1.0 : 2.0; }});
    EXPECT_EQ(pixels.at(2, 5), (Rgba{200, 30, 40, 255}));
    EXPECT_EQ(pixels.at(13, 5), (Rgba{20, 40, 250, 255}));
}

TEST_F(PhotoKinds, AlphaIsCoverage) {
    const Grid<Rgba> pixels =
        pixelsOf({.bands = 4, .type = "Byte", .lastBandIsAlpha = true, .value = [](int band, int64_t x, int64_t) {
                      if (band == 3) return x < 8 ? 0.0 : 255.0;
                      return 90.0;
                  }});
    EXPECT_EQ(pixels.at(7, 5), (Rgba{0, 0, 0, 0}));
    EXPECT_EQ(pixels.at(8, 5), (Rgba{90, 90, 90, 255}));
}

TEST_F(PhotoKinds, GreyWithAlphaIsCoverageToo) {
    const Grid<Rgba> pixels =
        pixelsOf({.bands = 2, .type = "Byte", .lastBandIsAlpha = true, .value = [](int band, int64_t x, int64_t) {
                      if (band == 1) return x < 8 ? 0.0 : 255.0;
                      return 90.0;
                  }});
    EXPECT_EQ(pixels.at(7, 5)[3], 0);
    EXPECT_EQ(pixels.at(8, 5), (Rgba{90, 90, 90, 255}));
}

TEST_F(PhotoKinds, NodataHidesAPixelOnlyWhenAllBandsHoldIt) {
    const Grid<Rgba> pixels =
        pixelsOf({.bands = 3, .type = "Byte", .nodata = 0, .value = [](int band, int64_t x, int64_t) {
                      if (x < 5) return 0.0;                      // nothing
                      if (x < 10) return band == 2 ? 80.0 : 0.0;  // a dark blue roof
                      return 120.0;
                  }});
    EXPECT_EQ(pixels.at(2, 5)[3], 0);
    EXPECT_EQ(pixels.at(7, 5), (Rgba{0, 0, 80, 255}));
    EXPECT_EQ(pixels.at(13, 5), (Rgba{120, 120, 120, 255}));
}

TEST_F(PhotoKinds, FloatsAreRefused) {
    const Refusal refusal = refusalOf([&] { (void)pixelsOf({.bands = 3, .type = "Float32"}); });
    EXPECT_EQ(refusal.code, ExitCode::input);
    EXPECT_TRUE(refusal.says("32-bit floats") && refusal.says("photo.tif")) << refusal.message;
}

TEST_F(PhotoKinds, CutShortAreRefused) {
    const RasterSpec spec{.bands = 3, .type = "Byte", .value = [](int, int64_t x, int64_t y) {
                              return static_cast<double>((x * 31 + y * 17) % 256);
                          }};
    (void)pixelsOf(spec);
    std::filesystem::resize_file(file_, std::filesystem::file_size(file_) - 300);
    const Refusal refusal = refusalOf([&] {
        (void)readCells(*openGdalPhotos({.files = {file_}, .cacheBytes = 1 << 20}, kTiling, {512, 512}, "EPSG:32632"),
                        {0, 0, 16, 16});
    });
    EXPECT_EQ(refusal.code, ExitCode::input);
    EXPECT_TRUE(refusal.says("photo.tif")) << refusal.message;
}

TEST_F(PhotoKinds, HolesShowThePhotoBelow) {
    const RasterSpec below{.size = {16, 16},
                           .bands = 3,
                           .type = "Byte",
                           .transform = northUp(500000, 5200000, 1),
                           .crs = "EPSG:32632",
                           .value = [](int, int64_t, int64_t) { return 50.0; }};
    RasterSpec above = below;
    above.nodata = 0;
    above.value = [](int, int64_t x, int64_t) { return x < 8 ? 0.0 : 200.0; };
    const std::vector<std::string> files{writeRaster((folder_ / "below.tif").string(), below),
                                         writeRaster((folder_ / "above.tif").string(), above)};
    const Grid<Rgba> pixels = readCells(
        *openGdalPhotos({.files = files, .cacheBytes = 1 << 20}, kTiling, {512, 512}, "EPSG:32632"), {0, 0, 16, 16});
    EXPECT_EQ(pixels.at(3, 3), (Rgba{50, 50, 50, 255}));
    EXPECT_EQ(pixels.at(12, 3), (Rgba{200, 200, 200, 255}));
}

}  // namespace
}  // namespace terray::test
