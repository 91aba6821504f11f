// What openGdalHeights() refuses, and what it says.

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/preprocess_sources/raster_writer.h"

namespace terray::test {
namespace {

class GdalRefusal : public testing::Test {
  protected:
    Refusal open() {
        return refusalOf([this] { (void)openGdalHeights(options_); });
    }
    /// Opens and reads everything.
    Refusal read() {
        return refusalOf([this] { (void)readAll(*openGdalHeights(options_)); });
    }
    void useText(const std::string& name, const std::string& text) {
        options_.files = {(folder_ / name).string()};
        std::ofstream(options_.files[0]) << text;
    }
    void useRaster(const RasterSpec& spec) { options_.files = {writeRaster((folder_ / "heights.tif").string(), spec)}; }

    TemporaryDirectory folder_;
    HeightSourceOptions options_;
};

RasterSpec inZone32() {
    return {.size = {64, 64}, .transform = northUp(500000, 5200000, 10), .crs = "EPSG:32632"};
}

TEST_F(GdalRefusal, NamesAMissingFile) {
    options_.files = {(folder_ / "absent.tif").string()};
    const Refusal refusal = open();
    EXPECT_EQ(refusal.code, ExitCode::input);
    EXPECT_TRUE(refusal.says("absent.tif") && refusal.says("no such file")) << refusal.message;
}

TEST_F(GdalRefusal, TellsWhatIsNoRaster) {
    useText("letter.txt", "Dear reader, this is a letter.\n");
    const Refusal refusal = open();
    EXPECT_EQ(refusal.code, ExitCode::input);
    EXPECT_TRUE(refusal.says("letter.txt") && refusal.says("no raster") && refusal.says("not recognized"))
        << refusal.message;
}

TEST_F(GdalRefusal, TellsAnEmptyFile) {
    useText("empty.tif", "");
    const Refusal refusal = open();
    EXPECT_EQ(refusal.code, ExitCode::input);
    EXPECT_TRUE(refusal.says("0 bytes")) << refusal.message;
}

TEST_F(GdalRefusal, TellsAFileThatIsCutShort) {
    RasterSpec spec = inZone32();
    spec.value = [](int, int64_t x, int64_t y) { return std::sin(static_cast<double>(x * y)); };
    for (const char* compression : {"COMPRESS=NONE", "COMPRESS=DEFLATE"}) {
        spec.creationOptions = {compression};
        useRaster(spec);
        const auto whole = std::filesystem::file_size(options_.files[0]);
        for (const auto kept : {whole * 9 / 10, whole / 2, uintmax_t{300}, uintmax_t{10}}) {
            std::filesystem::resize_file(options_.files[0], kept);
            const Refusal refusal = read();
            EXPECT_EQ(refusal.code, ExitCode::input) << compression << " " << kept;
            EXPECT_TRUE(refusal.says("heights.tif") && refusal.says("GDAL says")) << refusal.message;
        }
    }
}

TEST_F(GdalRefusal, TellsAFileThatIsCutShortAlsoThroughAWarp) {
    RasterSpec spec = inZone32();
    spec.crs = "EPSG:4326";
    spec.transform = northUp(9, 47, 0.001);
    useRaster(spec);
    std::filesystem::resize_file(options_.files[0], std::filesystem::file_size(options_.files[0]) / 2);
    const Refusal refusal = read();
    EXPECT_EQ(refusal.code, ExitCode::input);
    EXPECT_TRUE(refusal.says("heights.tif")) << refusal.message;
}

TEST_F(GdalRefusal, AsksForASpacingWhenNothingSaysWhereTheRasterLies) {
    RasterSpec spec = inZone32();
    spec.transform.reset();
    spec.crs = "";
    useRaster(spec);
    const Refusal refusal = open();
    EXPECT_EQ(refusal.code, ExitCode::georeference);
    EXPECT_TRUE(refusal.says("--spacing")) << refusal.message;
}

TEST_F(GdalRefusal, RefusesAnUnknownSystem) {
    useRaster(inZone32());
    options_.crs = "EPSG:99999";
    const Refusal refusal = open();
    EXPECT_EQ(refusal.code, ExitCode::georeference);
    EXPECT_TRUE(refusal.says("EPSG:99999")) << refusal.message;
}

TEST_F(GdalRefusal, RefusesToBuildInDegreesOrFeet) {
    useRaster(inZone32());
    for (const char* crs : {"EPSG:4326", "EPSG:2263"}) {
        options_.crs = crs;
        const Refusal refusal = open();
        EXPECT_EQ(refusal.code, ExitCode::georeference) << crs;
        EXPECT_TRUE(refusal.says(crs) && refusal.says("metres")) << refusal.message;
    }
}

TEST_F(GdalRefusal, RefusesASystemThatIsNotDefinedWhereTheRasterLies) {
    RasterSpec spec = inZone32();
    spec.crs = "EPSG:4326";
    spec.transform = northUp(100, 20, 0.001);
    useRaster(spec);
    options_.crs = "ESRI:102016";  // azimuthal around the north pole: defined here; the gnomonic one below is not
    EXPECT_EQ(open().code, ExitCode::ok);
    options_.crs = "+proj=gnom +lat_0=0 +lon_0=-80 +units=m";
    EXPECT_EQ(open().code, ExitCode::georeference);
}

// GDAL reads sizes modulo 2^32: 4,294,967,396 columns would become 100.
TEST_F(GdalRefusal, RefusesASpacingThatMakesMoreCellsThanGdalCounts) {
    HeightSourceOptions options;
    options.files = {writeRaster((folder_ / "heights.tif").string(),
                                 {.size = {10, 10}, .transform = northUp(500000, 5200000, 10), .crs = "EPSG:32632"})};
    for (const double spacing : {100 / 4294967396.0, 1e-20}) {
        options.spacing = spacing;
        const Refusal refusal = refusalOf([&] { (void)openGdalHeights(options); });
        EXPECT_EQ(refusal.code, ExitCode::input);
        EXPECT_TRUE(refusal.says("coarser --spacing")) << refusal.message;
    }
}

TEST_F(GdalRefusal, RefusesToMosaicWhatHasNoPlace) {
    useRaster(inZone32());
    RasterSpec plain = inZone32();
    plain.transform.reset();
    plain.crs = "";
    options_.files.push_back(writeRaster((folder_ / "plain.tif").string(), plain));
    options_.spacing = 10;
    const Refusal refusal = open();
    EXPECT_EQ(refusal.code, ExitCode::georeference);
    EXPECT_TRUE(refusal.says("plain.tif")) << refusal.message;
}

TEST_F(GdalRefusal, PrintsNothingItself) {
    testing::internal::CaptureStderr();
    useText("letter.txt", "Dear reader");
    (void)open();
    useRaster(inZone32());
    std::filesystem::resize_file(options_.files[0], 900);
    (void)read();
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace terray::test
