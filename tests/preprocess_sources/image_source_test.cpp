// Plain height images through OpenImageIO.

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/preprocess_sources/raster_writer.h"

namespace terray::test {
namespace {

double irregular(int64_t x, int64_t y) {
    return static_cast<double>((x * 7919 + y * 104729 + x * y * 31) % 65536);
}

class PlainImage : public testing::Test {
  protected:
    void usePng(const std::string& type, const std::function<double(int, int64_t, int64_t)>& value) {
        options_.files = {writeRaster((folder_ / "heights.png").string(),
                                      {.size = {700, 530}, .type = type, .driver = "PNG", .value = value})};
        options_.spacing = 10;
    }
    TemporaryDirectory folder_;
    HeightSourceOptions options_;
};

TEST_F(PlainImage, ReadsSixteenBitSamplesAsTheyAreStoredUpToEveryBorder) {
    usePng("UInt16", [](int, int64_t x, int64_t y) { return irregular(x, y); });
    const auto source = openImageHeights(options_);
    EXPECT_EQ(source->info().size, (GridSize{700, 530}));
    EXPECT_EQ(source->info().west, 0);
    EXPECT_EQ(source->info().north, 0);
    EXPECT_EQ(source->info().spacing, 10);
    EXPECT_EQ(source->info().sourceStep, 1);
    EXPECT_EQ(source->info().crsWkt, "");
    constexpr int64_t kMargin = 2;
    const Grid<float> heights = readAll(*source, kMargin);
    for (int64_t y = -kMargin; y < 530 + kMargin; ++y)
        for (int64_t x = -kMargin; x < 700 + kMargin; ++x) {
            const float height = heights.at(x + kMargin, y + kMargin);
            if (x < 0 || x >= 700 || y < 0 || y >= 530)
                ASSERT_TRUE(std::isnan(height)) << x << ", " << y;
            else
                ASSERT_EQ(height, static_cast<float>(irregular(x, y))) << x << ", " << y;
        }
}

TEST_F(PlainImage, ReadsEightBitSamplesWithScaleOffsetAndNodata) {
    usePng("Byte", [](int, int64_t x, int64_t) { return static_cast<double>(x % 256); });
    options_.heightScale = 0.5;
    options_.heightOffset = -3;
    options_.nodata = 7;
    const auto source = openImageHeights(options_);
    EXPECT_EQ(source->info().sourceStep, 0.5);
    const Grid<float> heights = readAll(*source);
    EXPECT_EQ(heights.at(255, 3), 255 * 0.5 - 3);
    EXPECT_TRUE(std::isnan(heights.at(7, 3)));
}

TEST_F(PlainImage, ReadsFloatTiffs) {
    options_.files = {writeRaster((folder_ / "heights.tif").string(),
                                  {.size = {33, 9}, .value = [](int, int64_t x, int64_t y) {
                                       return y == 3 ? std::nan("") : -1000.25 + static_cast<double>(x);
                                   }})};
    options_.spacing = 2;
    const auto source = openImageHeights(options_);
    EXPECT_EQ(source->info().sourceStep, 0);
    const Grid<float> heights = readAll(*source);
    EXPECT_EQ(heights.at(32, 8), -968.25f);
    EXPECT_TRUE(std::isnan(heights.at(0, 3)));
}

TEST_F(PlainImage, IsToldFromAGeoreferencedRaster) {
    usePng("UInt16", [](int, int64_t, int64_t) { return 1.0; });
    EXPECT_TRUE(isPlainImage(options_.files[0]));
    EXPECT_FALSE(isPlainImage((folder_ / "absent.png").string()));
    EXPECT_FALSE(isPlainImage(writeRaster((folder_ / "placed.tif").string(), {.transform = northUp(0, 0, 1)})));
    EXPECT_FALSE(
        isPlainImage(writeRaster((folder_ / "signed.tif").string(), {.type = "Int16"})));  // read exactly by GDAL alone
    std::ofstream((folder_ / "heights.pgw").string()) << "10\n0\n0\n-10\n5\n-5\n";
    EXPECT_FALSE(isPlainImage(options_.files[0]));
}

TEST_F(PlainImage, IsRefusedWithoutASpacing) {
    usePng("UInt16", [](int, int64_t, int64_t) { return 1.0; });
    options_.spacing.reset();
    const Refusal refusal = refusalOf([&] { (void)openImageHeights(options_); });
    EXPECT_EQ(refusal.code, ExitCode::georeference);
    EXPECT_TRUE(refusal.says("--spacing")) << refusal.message;
}

TEST_F(PlainImage, IsRefusedWhenMissingEmptyOrNoImage) {
    options_.spacing = 1;
    options_.files = {(folder_ / "absent.png").string()};
    EXPECT_TRUE(refusalOf([&] { (void)openImageHeights(options_); }).says("no such file"));
    options_.files = {(folder_ / "empty.png").string()};
    std::ofstream(options_.files[0]) << "";
    EXPECT_TRUE(refusalOf([&] { (void)openImageHeights(options_); }).says("0 bytes"));
    options_.files = {(folder_ / "letter.png").string()};
    std::ofstream(options_.files[0]) << "Dear reader";
    const Refusal refusal = refusalOf([&] { (void)openImageHeights(options_); });
    EXPECT_EQ(refusal.code, ExitCode::input);
    EXPECT_TRUE(refusal.says("no image")) << refusal.message;
}

TEST_F(PlainImage, IsRefusedWhenCutShort) {
    usePng("UInt16", [](int, int64_t x, int64_t y) { return irregular(x, y); });
    const auto whole = std::filesystem::file_size(options_.files[0]);
    for (const auto kept : {whole * 99 / 100, whole / 2}) {
        std::filesystem::resize_file(options_.files[0], kept);
        const Refusal refusal = refusalOf([&] { (void)readAll(*openImageHeights(options_)); });
        EXPECT_EQ(refusal.code, ExitCode::input) << kept;
        EXPECT_TRUE(refusal.says("heights.png")) << refusal.message;
    }
}

TEST_F(PlainImage, IsRefusedAsPartOfAMosaic) {
    usePng("UInt16", [](int, int64_t, int64_t) { return 1.0; });
    options_.files.push_back(options_.files[0]);
    EXPECT_EQ(refusalOf([&] { (void)openImageHeights(options_); }).code, ExitCode::georeference);
}

}  // namespace
}  // namespace terray::test
