// Heights of several files: what they agree and disagree in, and that no seam shows.

#include <cmath>
#include <limits>
#include <thread>

#include <gtest/gtest.h>

#include "tests/preprocess_sources/raster_writer.h"

namespace terray::test {
namespace {

/// A surface over longitude and latitude.
double inclined(LonLat place) {
    return 400 + 5000 * (place.longitude - 12) - 3000 * (place.latitude - 47);
}

class GdalMosaic : public testing::Test {
  protected:
    std::string add(const std::string& name, const RasterSpec& spec) {
        options_.files.push_back(writeRaster((folder_ / name).string(), spec));
        return options_.files.back();
    }
    TemporaryDirectory folder_;
    HeightSourceOptions options_;
};

RasterSpec constant(double west, double north, double height) {
    return {.size = {10, 10},
            .type = "Int16",
            .transform = northUp(west, north, 10),
            .crs = "EPSG:32632",
            .nodata = -1,
            .value = [height](int, int64_t, int64_t) { return height; }};
}

TEST_F(GdalMosaic, PassesSamplesOnUntouchedWhenTheFilesShareAGrid) {
    add("west.tif", constant(500000, 5200000, 1));
    add("east.tif", constant(500100, 5200050, 2));
    const auto source = openGdalHeights(options_);
    EXPECT_EQ(source->info().size, (GridSize{20, 15}));
    EXPECT_EQ(source->info().north, 5200050);
    EXPECT_EQ(source->info().sourceStep, 1);
    EXPECT_EQ(source->info().files.size(), 2u);
    const Grid<float> heights = readAll(*source);
    EXPECT_TRUE(std::isnan(heights.at(0, 4)));
    EXPECT_EQ(heights.at(0, 5), 1);
    EXPECT_EQ(heights.at(9, 14), 1);
    EXPECT_EQ(heights.at(10, 0), 2);
    EXPECT_EQ(heights.at(19, 9), 2);
    EXPECT_TRUE(std::isnan(heights.at(19, 10)));
}

TEST_F(GdalMosaic, LaysLaterFilesOnTopExceptWhereTheyHaveNoData) {
    add("below.tif", constant(500000, 5200000, 1));
    RasterSpec above = constant(500000, 5200000, 2);
    above.nodata = -7;
    above.value = [](int, int64_t x, int64_t) { return x < 3 ? -7.0 : 2.0; };
    add("above.tif", above);
    const Grid<float> heights = readAll(*openGdalHeights(options_));
    EXPECT_EQ(heights.at(2, 0), 1);
    EXPECT_EQ(heights.at(3, 0), 2);
}

/// Half of a plane in degrees: `columns` from `first` on.
RasterSpec degreesPart(int64_t first, int64_t columns) {
    constexpr double kStep = 0.001;
    return {.size = {columns, 60},
            .transform = northUp(12 + static_cast<double>(first) * kStep, 47, kStep),
            .crs = "EPSG:4326",
            .value = [first](int, int64_t x, int64_t y) {
                return inclined({.longitude = 12 + (static_cast<double>(first + x) + 0.5) * kStep,
                                 .latitude = 47 - (static_cast<double>(y) + 0.5) * kStep});
            }};
}

TEST_F(GdalMosaic, WarpsAdjacentFilesAsIfTheyWereOne) {
    add("whole.tif", degreesPart(0, 100));
    const Grid<float> whole = readAll(*openGdalHeights(options_));
    options_.files.clear();
    add("west.tif", degreesPart(0, 37));
    add("east.tif", degreesPart(37, 63));
    const Grid<float> parts = readAll(*openGdalHeights(options_));
    ASSERT_EQ(parts.size(), whole.size());
    for (size_t i = 0; i < whole.cells().size(); ++i) {
        ASSERT_EQ(std::isnan(whole.cells()[i]), std::isnan(parts.cells()[i])) << i;
        // The last digit of a coordinate differs, by 1e-9 of a cell, and so may that of a 32-bit height.
        if (std::isnan(whole.cells()[i])) continue;
        ASSERT_NEAR(whole.cells()[i], parts.cells()[i], 1e-4) << i;
    }
}

TEST_F(GdalMosaic, WarpsFilesOfDifferentSystemsOntoTheFirstOnesGrid) {
    // Neighbours across the border of zones 32 and 33 at 12 E, one kilometre of overlap.
    const auto part = [](const std::string& crs, double longitude) {
        const auto [x, y] = placeOf(crs, {.longitude = longitude, .latitude = 47});
        const double west = std::round(x);
        const double north = std::round(y);
        return RasterSpec{.size = {160, 100},
                          .transform = northUp(west, north, 50),
                          .crs = crs,
                          .nodata = -9999,
                          .value = [=](int, int64_t column, int64_t row) {
                              return inclined(lonLatOf(crs, west + (static_cast<double>(column) + 0.5) * 50,
                                                       north - (static_cast<double>(row) + 0.5) * 50));
                          }};
    };
    add("zone32.tif", part("EPSG:32632", 11.91));
    add("zone33.tif", part("EPSG:32633", 12.0));
    std::string notes;
    options_.note = [&](const std::string& text) { notes += text + "\n"; };
    const auto source = openGdalHeights(options_);
    const HeightGridInfo& info = source->info();
    EXPECT_EQ(info.crsName, "EPSG:32632");
    EXPECT_EQ(info.spacing, 50);
    EXPECT_NE(notes.find("resampled"), std::string::npos) << notes;
    const Grid<float> heights = readAll(*source);
    int64_t checked = 0;
    int64_t atTheSeam = 0;
    for (int64_t y = 20; y < 80; y += 4)
        for (int64_t x = 4; x < 280; x += 4) {
            const LonLat place = lonLatOf("EPSG:32632", info.west + (static_cast<double>(x) + 0.5) * 50,
                                          info.north - (static_cast<double>(y) + 0.5) * 50);
            ASSERT_FALSE(std::isnan(heights.at(x, y))) << x << ", " << y;
            // A cell rises 3.3 m to the east and 1.3 m to the north. The approximate transformer may be an eighth of a
            // cell off; where the upper file ends there is nothing to interpolate with for another half.
            const double error = std::abs(heights.at(x, y) - inclined(place));
            ASSERT_LT(error, 0.625 * (3.3 + 1.3)) << x << ", " << y;
            if (error > 0.125 * (3.3 + 1.3)) ++atTheSeam;
            ++checked;
        }
    EXPECT_EQ(checked, 15 * 69);
    EXPECT_LE(atTheSeam, 15);
}

TEST_F(GdalMosaic, KeepsTheFinestOfSeveralSpacings) {
    add("fine.tif", constant(500000, 5200000, 5));
    RasterSpec coarse = constant(500100, 5200000, 5);
    coarse.transform = northUp(500100, 5200000, 20);
    coarse.size = {5, 5};
    add("coarse.tif", coarse);
    const auto source = openGdalHeights(options_);
    EXPECT_EQ(source->info().spacing, 10);
    EXPECT_EQ(source->info().size, (GridSize{20, 10}));
    const Grid<float> heights = readAll(*source);
    for (const float height : heights.cells()) ASSERT_EQ(height, 5);
}

/// Covers the same ground as constant() of that corner with cells twice as wide.
RasterSpec coarser(double west, double north, double height) {
    RasterSpec spec = constant(west, north, height);
    spec.transform = northUp(west, north, 20);
    spec.size = {5, 5};
    return spec;
}

TEST_F(GdalMosaic, LaysTheFinestOnTopUnlessTheOrderIsToDecide) {
    add("fine.tif", constant(500000, 5200000, 1));
    add("coarse.tif", coarser(500000, 5200000, 2));
    EXPECT_EQ(readAll(*openGdalHeights(options_)).at(5, 5), 1);
    options_.priority = MosaicPriority::order;
    EXPECT_EQ(readAll(*openGdalHeights(options_)).at(5, 5), 2);
    std::ranges::reverse(options_.files);
    EXPECT_EQ(readAll(*openGdalHeights(options_)).at(5, 5), 1);
    options_.priority = MosaicPriority::resolution;
    EXPECT_EQ(readAll(*openGdalHeights(options_)).at(5, 5), 1);
}

TEST_F(GdalMosaic, ComparesDegreesWithMetres) {
    // 0.0001 degrees are 11 m.
    add("metres.tif", constant(500000, 5200000, 1));
    const LonLat corner = lonLatOf("EPSG:32632", 500000, 5200000);
    add("degrees.tif", {.size = {20, 20},
                        .transform = northUp(corner.longitude - 0.0002, corner.latitude + 0.0002, 0.0001),
                        .crs = "EPSG:4326",
                        .value = [](int, int64_t, int64_t) { return 2.0; }});
    EXPECT_EQ(readAll(*openGdalHeights(options_)).at(5, 5), 1);
    options_.files.erase(options_.files.begin());
    options_.files.push_back(writeRaster((folder_ / "thirty.tif").string(), coarser(500000, 5200000, 3)));
    const auto source = openGdalHeights(options_);
    // The system is that of the first file given, whichever lies on top.
    EXPECT_EQ(source->info().crsName, "EPSG:32632");
    const Grid<float> heights = readAll(*source);
    EXPECT_NEAR(heights.at(heights.width() / 2, heights.size().height / 2), 2, 1e-3);
}

TEST_F(GdalMosaic, TakesOnlyTheCellsThatTouchTheAreaAskedFor) {
    RasterSpec spec = constant(500000, 5200000, 0);
    spec.value = [](int, int64_t x, int64_t y) { return static_cast<double>(10 * x + y); };
    add("a.tif", spec);
    const Grid<float> whole = readAll(*openGdalHeights(options_));
    options_.bounds = GroundRect{500025, 5199950, 500060, 5199990.5};
    const auto source = openGdalHeights(options_);
    EXPECT_EQ(source->info().size, (GridSize{4, 5}));
    EXPECT_EQ(source->info().west, 500020);
    EXPECT_EQ(source->info().north, 5200000);
    const Grid<float> part = readAll(*source);
    for (int64_t y = 0; y < 5; ++y)
        for (int64_t x = 0; x < 4; ++x) ASSERT_EQ(part.at(x, y), whole.at(x + 2, y));
    options_.bounds = GroundRect{0, 0, 9e6, 9e6};
    EXPECT_EQ(openGdalHeights(options_)->info().size, (GridSize{10, 10}));
    options_.bounds = GroundRect{400000, 5199950, 400060, 5199990};
    const Refusal refusal = refusalOf([&] { (void)openGdalHeights(options_); });
    EXPECT_EQ(refusal.code, ExitCode::georeference);
    EXPECT_TRUE(refusal.says("--bbox") && refusal.says("500000")) << refusal.message;
}

TEST_F(GdalMosaic, TakesPartOfWhatIsResampled) {
    add("degrees.tif", degreesPart(0, 100));
    const HeightGridInfo whole = openGdalHeights(options_)->info();
    const double middle = whole.west + 0.5 * static_cast<double>(whole.size.width) * whole.spacing;
    options_.bounds = GroundRect{middle, 0, 9e6, 9e6};
    const auto source = openGdalHeights(options_);
    EXPECT_EQ(source->info().size.height, whole.size.height);
    EXPECT_NEAR(static_cast<double>(source->info().size.width), static_cast<double>(whole.size.width) / 2, 1);
    EXPECT_EQ(source->info().spacing, whole.spacing);
}

TEST_F(GdalMosaic, RefusesFilesOfDifferentUnits) {
    add("metres.tif", constant(500000, 5200000, 1));
    RasterSpec feet = constant(500100, 5200000, 1);
    feet.unit = "ft";
    add("feet.tif", feet);
    const Refusal refusal = refusalOf([&] { (void)openGdalHeights(options_); });
    EXPECT_EQ(refusal.code, ExitCode::input);
    EXPECT_TRUE(refusal.says("feet.tif") && refusal.says("\"ft\"")) << refusal.message;
}

TEST_F(GdalMosaic, GivesEveryThreadTheSameHeights) {
    for (int64_t i = 0; i < 4; ++i) add("part" + std::to_string(i) + ".tif", degreesPart(25 * i, 25));
    const auto source = openGdalHeights(options_);
    const Grid<float> expected = readAll(*source);
    std::vector<Grid<float>> found(4);
    {
        std::vector<std::jthread> threads;
        for (Grid<float>& heights : found)
            threads.emplace_back([&source, &heights] {
                for (int round = 0; round < 5; ++round) heights = readAll(*source);
            });
    }
    for (const Grid<float>& heights : found)
        for (size_t i = 0; i < expected.cells().size(); ++i) {
            if (std::isnan(expected.cells()[i])) continue;
            ASSERT_EQ(heights.cells()[i], expected.cells()[i]);
        }
}

TEST_F(GdalMosaic, ReadsAMosaicThatOutlivesItsOptions) {
    add("only.tif", degreesPart(0, 100));
    auto source = openGdalHeights(options_);
    const std::unique_ptr<HeightReader> reader = source->openReader();
    options_ = {};
    Grid<float> heights({10, 10});
    reader->read({30, 30, 10, 10}, heights.view());
    EXPECT_FALSE(std::isnan(heights.at(5, 5)));
}

}  // namespace
}  // namespace terray::test
