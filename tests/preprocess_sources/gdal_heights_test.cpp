// Heights of one file through GDAL: what is passed on untouched, and what a warp makes of it.

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "preprocess/gdal_raster.h"
#include "tests/preprocess_sources/raster_writer.h"

namespace terray::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// An irregular height for each sample, exact in 16 bits.
double irregular(int64_t x, int64_t y) {
    return static_cast<double>((x * 7919 + y * 104729 + x * y * 31) % 20011) - 5000;
}

RasterSpec irregularSpec() {
    return {.size = {37, 23},
            .type = "Int16",
            .transform = northUp(500000, 5200000, 30),
            .crs = "EPSG:32632",
            .value = [](int, int64_t x, int64_t y) { return irregular(x, y); }};
}

class GdalHeights : public testing::Test {
  protected:
    std::unique_ptr<HeightSource> open(const RasterSpec& spec) {
        options_.files = {writeRaster((folder_ / "heights.tif").string(), spec)};
        options_.note = [this](const std::string& text) { notes_ += text + "\n"; };
        return openGdalHeights(options_);
    }
    [[nodiscard]] bool noted(const std::string& text) const { return notes_.find(text) != std::string::npos; }

    TemporaryDirectory folder_;
    HeightSourceOptions options_;
    std::string notes_;
};

TEST_F(GdalHeights, PassesSamplesOnUntouchedUpToEveryBorder) {
    const auto source = open(irregularSpec());
    const HeightGridInfo& info = source->info();
    EXPECT_EQ(info.size, (GridSize{37, 23}));
    EXPECT_EQ(info.west, 500000);
    EXPECT_EQ(info.north, 5200000);
    EXPECT_EQ(info.spacing, 30);
    EXPECT_EQ(info.crsName, "EPSG:32632");
    EXPECT_EQ(info.sourceStep, 1);
    ASSERT_EQ(info.files.size(), 1u);
    EXPECT_EQ(info.files[0].bytes, std::filesystem::file_size(options_.files[0]));
    EXPECT_EQ(notes_, "");
    constexpr int64_t kMargin = 3;
    const Grid<float> heights = readAll(*source, kMargin);
    for (int64_t y = -kMargin; y < 23 + kMargin; ++y)
        for (int64_t x = -kMargin; x < 37 + kMargin; ++x) {
            const float height = heights.at(x + kMargin, y + kMargin);
            if (x < 0 || x >= 37 || y < 0 || y >= 23)
                ASSERT_TRUE(std::isnan(height)) << x << ", " << y;
            else
                ASSERT_EQ(height, static_cast<float>(irregular(x, y))) << x << ", " << y;
        }
}

TEST_F(GdalHeights, GivesOnlyHolesWhereAWindowMissesTheGrid) {
    const auto source = open(irregularSpec());
    Grid<float> heights({4, 4}, 7.0f);
    source->openReader()->read({37, 0, 4, 4}, heights.view());
    for (const float height : heights.cells()) EXPECT_TRUE(std::isnan(height));
}

TEST_F(GdalHeights, KnowsWhereItLiesInDegrees) {
    const auto source = open(irregularSpec());
    ASSERT_TRUE(source->info().lonLatBounds);
    const LonLat corner = lonLatOf("EPSG:32632", 500000, 5200000);
    EXPECT_NEAR(source->info().lonLatBounds->west, corner.longitude, 1e-6);
    EXPECT_NEAR(source->info().lonLatBounds->north, corner.latitude, 1e-6);
}

// PROJ sees the north pole and then no longer looks for the south pole.
TEST_F(GdalHeights, KnowsThatAMapOfTheWholeEarthReachesBothPoles) {
    const Crs wide = gdal::describeCrs("+proj=laea +lat_0=0 +lon_0=0 +datum=WGS84 +units=m +no_defs +type=crs");
    const auto bounds = gdal::lonLatBounds({-1.27e7, -1.27e7, 1.27e7, 1.27e7}, wide.wkt);
    ASSERT_TRUE(bounds);
    EXPECT_EQ(*bounds, (GroundRect{-180, -90, 180, 90}));
}

TEST_F(GdalHeights, KnowsWherePolesAreNot) {
    const auto bounds = gdal::lonLatBounds({500000, 5190000, 510000, 5200000}, gdal::describeCrs("EPSG:32632").wkt);
    ASSERT_TRUE(bounds);
    EXPECT_NEAR(bounds->west, 9, 1e-6);
    EXPECT_LT(bounds->east, 9.2);
    EXPECT_LT(bounds->north, 47);
    EXPECT_FALSE(gdal::lonLatBounds({0, 0, 1, 1}, ""));
}

TEST_F(GdalHeights, MakesHolesOfNodataAndOfWhatIsNoNumber) {
    RasterSpec spec = irregularSpec();
    spec.type = "Float32";
    spec.nodata = -9999;
    spec.value = [](int, int64_t x, int64_t y) {
        if (y != 0) return 5.0;
        return std::array<double, 5>{-9999, kNan, kInfinity, -kInfinity, 42}[static_cast<size_t>(x % 5)];
    };
    const Grid<float> heights = readAll(*open(spec));
    for (int64_t x = 0; x < 4; ++x) EXPECT_TRUE(std::isnan(heights.at(x, 0))) << x;
    EXPECT_EQ(heights.at(4, 0), 42);
    EXPECT_EQ(heights.at(0, 1), 5);
}

TEST_F(GdalHeights, MakesHolesOfTheLeastFloatAsEsriWritesIt) {
    RasterSpec spec = irregularSpec();
    spec.type = "Float32";
    spec.nodata = -3.4028235e+38;
    spec.value = [](int, int64_t x, int64_t) { return x == 2 ? -3.4028234663852886e+38 : 1.0; };
    const Grid<float> heights = readAll(*open(spec));
    EXPECT_TRUE(std::isnan(heights.at(2, 0)));
    EXPECT_EQ(heights.at(3, 0), 1);
}

TEST_F(GdalHeights, TakesNodataFromTheOptionInsteadOfTheFile) {
    RasterSpec spec = irregularSpec();
    spec.nodata = 5;
    spec.value = [](int, int64_t x, int64_t) { return x == 0 ? 0.0 : 5.0; };
    options_.nodata = 0;
    const Grid<float> heights = readAll(*open(spec));
    EXPECT_TRUE(std::isnan(heights.at(0, 0)));
    EXPECT_EQ(heights.at(1, 0), 5);
}

TEST_F(GdalHeights, AppliesTheFilesScaleThenTheUsers) {
    RasterSpec spec = irregularSpec();
    spec.scale = 0.5;
    spec.offset = 10;
    spec.value = [](int, int64_t, int64_t) { return 100.0; };
    options_.heightScale = 3;
    options_.heightOffset = -7;
    const auto source = open(spec);
    EXPECT_EQ(readAll(*source).at(0, 0), (100 * 0.5 + 10) * 3 - 7);
    EXPECT_EQ(source->info().sourceStep, 1.5);
}

TEST_F(GdalHeights, TurnsFeetIntoMetresAndSaysSo) {
    RasterSpec spec = irregularSpec();
    spec.unit = "ft";
    spec.value = [](int, int64_t, int64_t) { return 1000.0; };
    EXPECT_FLOAT_EQ(readAll(*open(spec)).at(0, 0), 304.8f);
    EXPECT_TRUE(noted("\"ft\"")) << notes_;
}

TEST_F(GdalHeights, DoesNotConvertFeetWhenTheUserGivesAScale) {
    RasterSpec spec = irregularSpec();
    spec.unit = "ft";
    spec.value = [](int, int64_t, int64_t) { return 1000.0; };
    options_.heightScale = 2;
    EXPECT_EQ(readAll(*open(spec)).at(0, 0), 2000);
}

TEST_F(GdalHeights, TakesARasterWithoutSystemAsAnUnnamedPlane) {
    RasterSpec spec = irregularSpec();
    spec.crs = "";
    const auto source = open(spec);
    EXPECT_EQ(source->info().crsWkt, "");
    EXPECT_FALSE(source->info().lonLatBounds);
    EXPECT_EQ(readAll(*source).at(36, 22), static_cast<float>(irregular(36, 22)));
    EXPECT_TRUE(noted("unnamed plane")) << notes_;
}

TEST_F(GdalHeights, PlacesARasterWithoutGeoreferenceBySpacing) {
    RasterSpec spec = irregularSpec();
    spec.crs = "";
    spec.transform.reset();
    options_.spacing = 2.5;
    const auto source = open(spec);
    EXPECT_EQ(source->info().west, 0);
    EXPECT_EQ(source->info().north, 0);
    EXPECT_EQ(source->info().spacing, 2.5);
    EXPECT_EQ(readAll(*source).at(36, 22), static_cast<float>(irregular(36, 22)));
}

TEST_F(GdalHeights, KnowsThatAxesInDegreesMeanDegrees) {
    RasterSpec spec = irregularSpec();  // as netCDF files without a grid mapping look through GDAL
    spec.crs = "";
    spec.transform = northUp(9, 47, 0.001);
    spec.metadata = {{"lon#units", "degrees_east"}, {"lat#units", "degrees_north"}};
    EXPECT_EQ(open(spec)->info().crsName, "EPSG:32632");
}

/// A surface that is a plane over longitude and latitude, so that bilinear samples of it are exact.
double inclined(LonLat place) {
    return 400 + 5000 * (place.longitude - 9) - 3000 * (place.latitude - 47);
}

RasterSpec inclinedDegrees() {
    constexpr double kStep = 0.001;
    return {.size = {120, 90},
            .transform = northUp(9, 47, kStep),
            .crs = "EPSG:4326",
            .value = [](int, int64_t x, int64_t y) {
                return inclined({.longitude = 9 + (static_cast<double>(x) + 0.5) * kStep,
                                 .latitude = 47 - (static_cast<double>(y) + 0.5) * kStep});
            }};
}

/// Greatest deviation of a source from `inclined`, metres, and how many samples it has.
std::pair<double, int64_t> deviation(const HeightSource& source) {
    const HeightGridInfo& info = source.info();
    const Grid<float> heights = readAll(source);
    double worst = 0;
    int64_t count = 0;
    for (int64_t y = 0; y < heights.height(); y += 3)
        for (int64_t x = 0; x < heights.width(); x += 3) {
            if (std::isnan(heights.at(x, y))) continue;
            const LonLat place = lonLatOf(info.crsWkt, info.west + (static_cast<double>(x) + 0.5) * info.spacing,
                                          info.north - (static_cast<double>(y) + 0.5) * info.spacing);
            const bool isInner =
                place.longitude > 9.001 && place.longitude < 9.119 && place.latitude < 46.999 &&
                place.latitude > 46.911;  // beyond the outermost centres there is nothing to interpolate
            if (isInner) worst = std::max(worst, std::abs(heights.at(x, y) - inclined(place)));
            ++count;
        }
    return {worst, count};
}

TEST_F(GdalHeights, WarpsDegreesToTheZonesMetresAtTheFinestSpacing) {
    const auto source = open(inclinedDegrees());
    EXPECT_EQ(source->info().crsName, "EPSG:32632");
    EXPECT_TRUE(noted("EPSG:32632")) << notes_;
    // A step of 0.001 degrees to the east at 46.955 N, on the central meridian's scale (0.9996) and near it.
    EXPECT_NEAR(source->info().spacing, 76.1, 0.1);
    EXPECT_EQ(source->info().sourceStep, 0);
    const auto [worst, count] = deviation(*source);
    EXPECT_GT(count, 1200);
    // gdalwarp's transformer may be wrong by an eighth of a sample, 5 m (east) and 3 m (north) apart here; measured:
    // 0.01 m.
    EXPECT_LT(worst, 0.125 * (5 + 3));
}

TEST_F(GdalHeights, WarpsToTheSystemAndSpacingAskedFor) {
    options_.crs = "EPSG:2056";
    options_.spacing = 50;
    const auto source = open(inclinedDegrees());
    EXPECT_EQ(source->info().crsName, "EPSG:2056");
    EXPECT_EQ(source->info().spacing, 50);
    EXPECT_LT(deviation(*source).first, 0.125 * (5 + 3));
}

TEST_F(GdalHeights, DoesNotLetNodataBleedIntoItsNeighbours) {
    RasterSpec spec = inclinedDegrees();
    spec.nodata = -32768;
    spec.type = "Int16";
    spec.value = [](int, int64_t x, int64_t y) { return (x / 10 + y / 10) % 5 == 0 ? -32768.0 : 1234.0; };
    const auto source = open(spec);
    int64_t holes = 0;
    int64_t surface = 0;
    const Grid<float> heights = readAll(*source);
    for (const float height : heights.cells()) {
        if (std::isnan(height)) {
            ++holes;
            continue;
        }
        ++surface;
        ASSERT_EQ(height, 1234);
    }
    EXPECT_NEAR(static_cast<double>(holes) / static_cast<double>(holes + surface), 0.2, 0.06);
}

TEST_F(GdalHeights, ResamplesNonSquareCellsOnly) {
    RasterSpec spec = irregularSpec();
    spec.type = "Float32";
    spec.transform = GeoTransform{500000, 30, 0, 5200000, 0, -20};
    spec.value = [](int, int64_t x, int64_t y) { return static_cast<double>(30 * x) + static_cast<double>(20 * y); };
    const auto source = open(spec);
    EXPECT_NEAR(source->info().spacing, 20, 1e-6);  // the finer of the two
    EXPECT_EQ(source->info().size, (GridSize{56, 23}));
    const Grid<float> heights = readAll(*source);
    // Centre of sample (10, 10): 210 m east; the source's samples lie at 15, 45, ... m, where they are 0, 30, ...
    EXPECT_NEAR(heights.at(10, 10), (210 - 15) + 20 * 10, 0.1);
}

TEST_F(GdalHeights, ReadsSouthUpAndRotatedRasters) {
    RasterSpec spec = irregularSpec();
    spec.type = "Float32";
    spec.nodata = -9999;
    spec.transform = GeoTransform{500000, 30, 0, 5200000 - 23 * 30, 0, 30};
    const auto upright = open(spec);
    const Grid<float> flipped = readAll(*upright);
    EXPECT_EQ(upright->info().size, (GridSize{37, 23}));
    EXPECT_EQ(upright->info().north, 5200000);
    EXPECT_NEAR(flipped.at(5, 0), irregular(5, 22), 0.01);

    spec.transform = GeoTransform{500000, 0, 30, 5200000, -30, 0};  // columns run to the south
    const auto turned = open(spec);
    EXPECT_EQ(turned->info().size, (GridSize{23, 37}));
    EXPECT_NEAR(readAll(*turned).at(4, 9), irregular(9, 4), 0.01);
}

}  // namespace
}  // namespace terray::test
