// Photos through GDAL: that each pixel lands on the ground it shows, at every resolution and from every system.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/preprocess_sources/raster_writer.h"

namespace terray::test {
namespace {

constexpr Rgba kNothing{0, 0, 0, 0};
constexpr Rgba kGrass{60, 120, 40, 255};
constexpr Rgba kRed{255, 0, 0, 255};
constexpr Rgba kBlue{0, 0, 255, 255};

/// A photo of grass with a red pixel in the upper left corner and a blue one in the lower right.
RasterSpec cornersSpec(GridSize size, const GeoTransform& transform, const std::string& crs) {
    return {.size = size,
            .bands = 3,
            .type = "Byte",
            .transform = transform,
            .crs = crs,
            .value = [size](int band, int64_t x, int64_t y) -> double {
                const auto channel = static_cast<size_t>(band);
                if (x == 0 && y == 0) return kRed[channel];
                if (x == size.width - 1 && y == size.height - 1) return kBlue[channel];
                return kGrass[channel];
            }};
}

class GdalPhotos : public testing::Test {
  protected:
    std::unique_ptr<ColourSource> open(const std::vector<RasterSpec>& specs) {
        std::vector<std::string> files;
        for (const RasterSpec& spec : specs)
            files.push_back(writeRaster((folder_ / ("photo" + std::to_string(files.size()) + ".tif")).string(), spec));
        return openGdalPhotos({.files = files, .cacheBytes = 64 << 20}, tiling_, samples_, crs_);
    }

    TemporaryDirectory folder_;
    Tiling tiling_{.west = 500000, .north = 5200000, .finestSpacing = 1, .finestLevel = 3};
    GridSize samples_{4096, 4096};
    std::string crs_ = "EPSG:32632";
};

TEST_F(GdalPhotos, LandOnTheirGroundAtTheLaddersSpacing) {
    const auto photo = open({cornersSpec({100, 80}, northUp(500010, 5199980, 1), crs_)});
    EXPECT_EQ(photo->level(), 3u);
    EXPECT_EQ(photo->bounds(), (GroundRect{500010, 5199900, 500110, 5199980}));
    EXPECT_EQ(photo->files().size(), 1u);
    const Grid<Rgba> cells = readCells(*photo, {8, 18, 105, 85});
    for (int64_t y = 0; y < cells.height(); ++y)
        for (int64_t x = 0; x < cells.width(); ++x) {
            const bool isInside = x >= 2 && x < 102 && y >= 2 && y < 82;
            const Rgba expected = !isInside ? kNothing : x == 2 && y == 2 ? kRed : x == 101 && y == 81 ? kBlue : kGrass;
            ASSERT_EQ(cells.at(x, y), expected) << x << ", " << y;
        }
}

TEST_F(GdalPhotos, LandOnTheirGroundFourTimesFiner) {
    const auto photo = open({cornersSpec({128, 128}, northUp(500000, 5200000, 0.25), crs_)});
    EXPECT_EQ(photo->level(), 5u);
    const Grid<Rgba> cells = readCells(*photo, {0, 0, 129, 129});
    EXPECT_EQ(cells.at(0, 0), kRed);
    EXPECT_EQ(cells.at(1, 0), kGrass);
    EXPECT_EQ(cells.at(127, 127), kBlue);
    EXPECT_EQ(cells.at(128, 127), kNothing);
}

TEST_F(GdalPhotos, LandOnTheirGroundFourTimesCoarser) {
    const auto photo = open({cornersSpec({64, 64}, northUp(500400, 5199600, 4), crs_)});
    EXPECT_EQ(photo->level(), 1u);
    const Grid<Rgba> cells = readCells(*photo, {99, 99, 66, 66});
    EXPECT_EQ(cells.at(1, 1), kRed);
    EXPECT_EQ(cells.at(0, 0), kNothing);
    EXPECT_EQ(cells.at(2, 1), kGrass);
    EXPECT_EQ(cells.at(64, 64), kBlue);
}

TEST_F(GdalPhotos, LandOnTheirGroundBetweenTheLaddersSpacings) {
    // 0.7 m: kept at 0.5 m. A block of 3 x 3 red pixels in grass; the texels over its centre pixel are red.
    RasterSpec spec = cornersSpec({200, 200}, northUp(500000, 5200000, 0.7), crs_);
    spec.value = [](int band, int64_t x, int64_t y) -> double {
        const bool isBlock = x >= 150 && x < 153 && y >= 40 && y < 43;
        return (isBlock ? kRed : kGrass)[static_cast<size_t>(band)];
    };
    const auto photo = open({spec});
    EXPECT_EQ(photo->level(), 4u);
    const Grid<Rgba> cells = readCells(*photo, {0, 0, 280, 280});
    double sumX = 0;
    double sumY = 0;
    double sum = 0;
    for (int64_t y = 0; y < 280; ++y)
        for (int64_t x = 0; x < 280; ++x) {
            const double redness = (cells.at(x, y)[0] - 60.0) / 195;
            sumX += redness * (static_cast<double>(x) + 0.5) * 0.5;
            sumY += redness * (static_cast<double>(y) + 0.5) * 0.5;
            sum += redness;
        }
    EXPECT_NEAR(sumX / sum, 151.5 * 0.7, 0.05);  // the block's centre, to a tenth of a texel
    EXPECT_NEAR(sumY / sum, 41.5 * 0.7, 0.05);
    EXPECT_EQ(cells.at(212, 58), kRed);  // centre (106.25, 29.25) m lies on pixel (151.8, 41.8)
}

TEST_F(GdalPhotos, AreAveragedWhereTheLadderIsCoarser) {
    RasterSpec spec = cornersSpec({200, 200}, northUp(500000, 5200000, 0.9), crs_);  // kept at 1 m
    spec.value = [](int, int64_t x, int64_t y) { return (x + y) % 2 == 0 ? 0.0 : 200.0; };
    const auto photo = open({spec});
    EXPECT_EQ(photo->level(), 3u);
    double sum = 0;
    const Grid<Rgba> cells = readCells(*photo, {10, 10, 100, 100});
    for (const Rgba& cell : cells.cells()) sum += cell[0];
    EXPECT_NEAR(sum / 10000, 100, 1);
}

TEST_F(GdalPhotos, LandOnTheirGroundFromAnotherSystem) {
    // A photo in degrees; a red block of 5 x 5 pixels must be found where PROJ says it lies.
    constexpr double kStep = 1e-5;
    const LonLat corner = lonLatOf(crs_, 500300, 5199700);
    const GeoTransform transform = northUp(corner.longitude, corner.latitude, kStep);
    RasterSpec spec = cornersSpec({300, 200}, transform, "EPSG:4326");
    spec.value = [](int band, int64_t x, int64_t y) -> double {
        const bool isBlock = std::abs(x - 200) <= 2 && std::abs(y - 120) <= 2;
        return (isBlock ? kRed : kGrass)[static_cast<size_t>(band)];
    };
    const auto photo = open({spec});
    EXPECT_EQ(photo->level(), 4u);  // 0.76 m to the east: half metres
    const auto [x, y] =
        placeOf(crs_, {.longitude = corner.longitude + 200.5 * kStep, .latitude = corner.latitude - 120.5 * kStep});
    const auto column = static_cast<int64_t>(std::floor((x - tiling_.west) / 0.5));
    const auto row = static_cast<int64_t>(std::floor((tiling_.north - y) / 0.5));
    const Grid<Rgba> cells = readCells(*photo, {column - 12, row - 12, 25, 25});
    EXPECT_EQ(cells.at(12, 12), kRed);
    for (const auto& [dx, dy] : {std::pair{-12, 0}, {12, 0}, {0, -12}, {0, 12}})
        EXPECT_EQ(cells.at(12 + dx, 12 + dy), kGrass) << dx << ", " << dy;
}

TEST_F(GdalPhotos, MeetWithoutAGap) {
    RasterSpec west = cornersSpec({100, 50}, northUp(500000, 5200000, 0.7), crs_);
    west.value = [](int band, int64_t, int64_t) -> double { return kGrass[static_cast<size_t>(band)]; };
    RasterSpec east = west;
    east.transform = northUp(500070, 5200000, 0.7);
    const auto photo = open({west, east});
    EXPECT_EQ(photo->bounds(), (GroundRect{500000, 5199965, 500140, 5200000}));
    const Grid<Rgba> cells = readCells(*photo, {0, 0, 280, 70});
    for (const Rgba& cell : cells.cells()) ASSERT_EQ(cell, kGrass);
}

TEST_F(GdalPhotos, CoverOneAnotherInTheOrderGiven) {
    const RasterSpec below = cornersSpec({40, 40}, northUp(500000, 5200000, 1), crs_);
    RasterSpec onSameGrid = cornersSpec({10, 10}, northUp(500030, 5200000, 1), crs_);
    RasterSpec finer = cornersSpec({10, 10}, northUp(500000, 5199970, 0.5), crs_);
    const auto photo = open({below, onSameGrid, finer});
    EXPECT_EQ(photo->level(), 4u);  // the finest photo's
    const Grid<Rgba> cells = readCells(*photo, {0, 0, 80, 80});
    EXPECT_GT(cells.at(0, 0)[0], 240);  // red of the first, enlarged
    EXPECT_LT(cells.at(0, 0)[1], 20);
    EXPECT_GT(cells.at(60, 0)[0], 150);  // red of the second, enlarged beside grass of the first
    EXPECT_EQ(cells.at(0, 60), kRed);    // red of the third
    EXPECT_EQ(cells.at(9, 69), kBlue);
    EXPECT_EQ(cells.at(40, 40), kGrass);
}

TEST_F(GdalPhotos, GiveNothingFarFromWhereTheyAre) {
    const auto photo = open({cornersSpec({20, 20}, northUp(500000, 5200000, 1), crs_)});
    for (const GridRect& window : {GridRect{3000, 3000, 64, 64}, GridRect{-640, -640, 64, 64}}) {
        const Grid<Rgba> cells = readCells(*photo, window);
        for (const Rgba& cell : cells.cells()) ASSERT_EQ(cell, kNothing);
    }
}

TEST_F(GdalPhotos, AreCutAtTheHeightsBorder) {
    samples_ = {32, 32};
    const auto photo = open({cornersSpec({100, 100}, northUp(499950, 5200050, 1), crs_)});
    EXPECT_EQ(photo->bounds(), (GroundRect{500000, 5199968, 500032, 5200000}));
    const Grid<Rgba> cells = readCells(*photo, {-4, -4, 40, 40});
    EXPECT_EQ(cells.at(3, 10), kNothing);
    EXPECT_EQ(cells.at(4, 10), kGrass);
    EXPECT_EQ(cells.at(35, 10), kGrass);
    EXPECT_EQ(cells.at(36, 10), kNothing);
}

TEST_F(GdalPhotos, WithoutGeoreferenceAreStretchedOverAPlainImage) {
    crs_ = "";
    tiling_ = {.west = 0, .north = 0, .finestSpacing = 60, .finestLevel = 1};
    samples_ = {600, 600};
    RasterSpec spec = cornersSpec({1200, 1200}, {}, "");
    spec.transform.reset();
    const auto photo = open({spec});
    EXPECT_EQ(photo->level(), 2u);
    EXPECT_NEAR(photo->bounds().south, -36000, 1e-6);
    EXPECT_NEAR(photo->bounds().east, 36000, 1e-6);
    EXPECT_EQ(readCells(*photo, {0, 0, 1, 1}).at(0, 0), kRed);
    EXPECT_EQ(readCells(*photo, {1199, 1199, 1, 1}).at(0, 0), kBlue);
}

TEST_F(GdalPhotos, ThatMissTheHeightsAreRefusedWithBothExtents) {
    const Refusal refusal = refusalOf([&] { (void)open({cornersSpec({20, 20}, northUp(600000, 5200000, 1), crs_)}); });
    EXPECT_EQ(refusal.code, ExitCode::georeference);
    EXPECT_TRUE(refusal.says("W 600000") && refusal.says("W 500000") && refusal.says("photo0.tif")) << refusal.message;
}

TEST_F(GdalPhotos, WithoutGeoreferenceAreRefusedOverGeoreferencedHeights) {
    RasterSpec spec = cornersSpec({20, 20}, {}, "");
    spec.transform.reset();
    const Refusal refusal = refusalOf([&] { (void)open({spec}); });
    EXPECT_EQ(refusal.code, ExitCode::georeference);
    EXPECT_TRUE(refusal.says("does not say where it lies")) << refusal.message;
}

TEST_F(GdalPhotos, ThatAreMissingAreRefused) {
    const Refusal refusal = refusalOf(
        [&] { (void)openGdalPhotos({.files = {(folder_ / "absent.tif").string()}}, tiling_, samples_, crs_); });
    EXPECT_EQ(refusal.code, ExitCode::input);
    EXPECT_TRUE(refusal.says("no such file")) << refusal.message;
}

}  // namespace
}  // namespace terray::test
