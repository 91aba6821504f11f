// Heights from one vertical system in another, by PROJ and its grid of EGM96 (Debian's proj-data).

#include <cmath>

#include <gtest/gtest.h>

#include "preprocess/shifted_heights.h"
#include "tests/preprocess_sources/raster_writer.h"

namespace terray::test {
namespace {

/// Where the equator meets the meridian of Greenwich, in UTM 31N: there EGM96 is 17.16 m above the ellipsoid.
constexpr double kWest = 166021.44;
constexpr double kGeoid = 17.16;

class VerticalShifts : public testing::Test {
  protected:
    [[nodiscard]] std::unique_ptr<HeightSource> open(const std::string& crs, GridSize size = {9, 9},
                                                     double spacing = 10) const {
        const std::string file =
            writeRaster((folder_ / "dem.tif").string(),
                        {.size = size,
                         .transform = northUp(kWest - spacing * 4.5, spacing * 4.5, spacing),
                         .crs = crs,
                         .nodata = -1,
                         .value = [](int, int64_t x, int64_t y) { return x + y == 1 ? -1.0 : 100.0; }});
        return openGdalHeights({.files = {file}});
    }
    TemporaryDirectory folder_;
};

TEST_F(VerticalShifts, AddTheGeoidOnce) {
    const auto shifted = shiftHeights(open("EPSG:32631+5773"), "ellipsoid");
    EXPECT_EQ(shifted->info().verticalDatum, "ellipsoid");
    const Grid<float> heights = readAll(*shifted, 1);
    EXPECT_NEAR(heights.at(5, 5), 100 + kGeoid, 0.02);
    EXPECT_TRUE(std::isnan(heights.at(2, 1)));  // holes stay
    EXPECT_TRUE(std::isnan(heights.at(0, 0)));  // beyond the raster
}

TEST_F(VerticalShifts, KeepTheHeightsWhereBothSystemsAreOne) {
    const auto same = shiftHeights(open("EPSG:32631+5773"), "EPSG:5773");
    EXPECT_NEAR(readAll(*same).at(4, 4), 100, 1e-6);
    EXPECT_EQ(same->info().verticalDatum, "EGM96 height");
}

TEST_F(VerticalShifts, AreTheSameInEveryWindow) {
    const auto shifted = shiftHeights(open("EPSG:32631+5773", {400, 300}, 30), "ellipsoid");
    const Grid<float> whole = readAll(*shifted);
    for (const GridRect window : {GridRect{3, 5, 50, 40}, GridRect{127, 130, 70, 1}, GridRect{399, 0, 1, 300}}) {
        Grid<float> part({window.width, window.height});
        shifted->openReader()->read(window, part.view());
        for (int64_t y = 0; y < window.height; ++y)
            for (int64_t x = 0; x < window.width; ++x) {
                const float expected = whole.at(window.x + x, window.y + y);
                ASSERT_TRUE(part.at(x, y) == expected || (std::isnan(expected) && std::isnan(part.at(x, y))));
            }
    }
}

TEST_F(VerticalShifts, AreRefusedWhereTheSourceDoesNotSayWhatItsHeightsAreAbove) {
    const Refusal refusal = refusalOf([&] { (void)shiftHeights(open("EPSG:32631"), "ellipsoid"); });
    EXPECT_EQ(refusal.code, ExitCode::georeference);
    EXPECT_TRUE(refusal.says("compound")) << refusal.message;
}

TEST_F(VerticalShifts, AreRefusedToWhatIsNoVerticalSystem) {
    for (const char* system : {"EPSG:32632", "nonsense"}) {
        const Refusal refusal = refusalOf([&] { (void)shiftHeights(open("EPSG:32631+5773"), system); });
        EXPECT_EQ(refusal.code, ExitCode::georeference) << system;
        EXPECT_TRUE(refusal.says("expected a vertical system")) << refusal.message;
    }
}

TEST_F(VerticalShifts, AreRefusedWithoutTheirGrid) {
    // EGM2008's grid is not among Debian's.
    const Refusal refusal = refusalOf([&] { (void)shiftHeights(open("EPSG:32631+5773"), "EPSG:3855"); });
    EXPECT_EQ(refusal.code, ExitCode::georeference);
    EXPECT_TRUE(refusal.says("grid")) << refusal.message;
}

}  // namespace
}  // namespace terray::test
