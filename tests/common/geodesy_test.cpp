#include "common/geodesy.h"

#include <cmath>

#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include "common/projection.h"

namespace terray {
namespace {

TEST(Geodesy, MeasuresKnownDistances) {
    // Karney 2013, table 2's neighbourhood: the quarter meridian of WGS 84 is 10 001 965.729 m, and a degree of the
    // equator is its semi-major axis times pi / 180.
    EXPECT_NEAR(geodesicDistance({0, 0}, {0, 90}).value(), 10001965.729, 1e-3);
    EXPECT_NEAR(geodesicDistance({0, 0}, {1, 0}).value(), 6378137.0 * M_PI / 180, 1e-6);
    EXPECT_EQ(geodesicDistance({12, 34}, {12, 34}).value(), 0);
    // Across the antimeridian and over a pole.
    EXPECT_NEAR(geodesicDistance({179.5, 0}, {-179.5, 0}).value(), 6378137.0 * M_PI / 180, 1e-6);
    EXPECT_NEAR(geodesicDistance({0, 89}, {180, 89}).value(), 2 * geodesicDistance({0, 89}, {0, 90}).value(), 1e-6);
}

TEST(Geodesy, MeasuresToTheEastAndNorth) {
    const double degree = 6378137.0 * M_PI / 180;
    const glm::dvec2 east = geodesicOffset({179.5, 0}, {-179.5, 0});
    EXPECT_NEAR(east.x, degree, 1e-6);
    EXPECT_NEAR(east.y, 0, 1e-6);
    const glm::dvec2 south = geodesicOffset({30, 10}, {30, 9});
    EXPECT_NEAR(south.x, 0, 1e-6);
    EXPECT_NEAR(-south.y, geodesicDistance({30, 10}, {30, 9}).value(), 1e-6);
    // At the pole north is the far side of the meridian of `from`: to its own meridian it goes south.
    const glm::dvec2 fromPole = geodesicOffset({20, 90}, {20, 89});
    EXPECT_NEAR(fromPole.x, 0, 1e-6);
    EXPECT_LT(fromPole.y, -100e3);
    EXPECT_EQ(geodesicOffset({12, 34}, {12, 34}), glm::dvec2(0));
}

TEST(Geodesy, KnowsTheEllipsoidsRadii) {
    // Equator: b^2 / a and a. Poles: a^2 / b both.
    constexpr double kA = 6378137.0, kB = 6356752.314245;
    EXPECT_NEAR(curvatureRadii(0).meridian.value(), kB * kB / kA, 1e-3);
    EXPECT_NEAR(curvatureRadii(0).primeVertical.value(), kA, 1e-3);
    for (const double pole : {-90.0, 90.0}) {
        EXPECT_NEAR(curvatureRadii(pole).meridian.value(), kA * kA / kB, 1e-3);
        EXPECT_NEAR(curvatureRadii(pole).primeVertical.value(), kA * kA / kB, 1e-3);
    }
}

TEST(Geodesy, ChoosesTheZoneOfThePlace) {
    EXPECT_EQ(metricEpsg({-105, 37}), 32613);
    EXPECT_EQ(metricEpsg({8, 46}), 32632);
    EXPECT_EQ(metricEpsg({-70, -33}), 32719);
    EXPECT_EQ(metricEpsg({-180, 10}), 32601);
    EXPECT_EQ(metricEpsg({179.9, -10}), 32760);
    EXPECT_EQ(metricEpsg({5, 60}), 32632);   // Norway
    EXPECT_EQ(metricEpsg({20, 78}), 32633);  // Svalbard
    EXPECT_EQ(metricEpsg({0, 0}), 32631);
    EXPECT_EQ(metricEpsg({10, 84.5}), 5041);
    EXPECT_EQ(metricEpsg({10, 90}), 5041);
    EXPECT_EQ(metricEpsg({10, -85}), 5042);
}

TEST(GeodesyDeathTest, StopsOnPlacesOffTheEarth) {
    EXPECT_DEATH((void)curvatureRadii(-90.1), "latitude");
    EXPECT_DEATH((void)geodesicOffset({0, 0}, {0, 91}), "latitude");
    EXPECT_DEATH((void)metricEpsg({0, 91}), "latitude");
    EXPECT_DEATH((void)geodesicDistance({NAN, 0}, {0, 0}), "longitude");
}

#if TERRAY_WITH_PROJ

TEST(Projection, AgreesWithItsInverseAndWithGeodesics) {
    const auto projection = Projection::create("EPSG:32613");
    ASSERT_TRUE(projection.ok()) << projection.failure().message;
    const glm::dvec2 place(450000, 4170000);
    const auto lonLat = projection->lonLat(place);
    ASSERT_TRUE(lonLat.ok());
    const auto back = projection->plane(*lonLat);
    ASSERT_TRUE(back.ok());
    EXPECT_NEAR(back->x, place.x, 1e-6);
    EXPECT_NEAR(back->y, place.y, 1e-6);
    // UTM scales by 0.9996 on its central meridian and by 3e-5 more at 50 km from it.
    const auto north = projection->lonLat(place + glm::dvec2(0, 1000));
    EXPECT_NEAR(geodesicDistance(*lonLat, *north).value(), 1000 / 0.99963, 0.01);
}

TEST(Projection, PutsEastFirstWhateverTheDefinitionSays) {
    // EPSG:3857's axes are east, north; EPSG:2193 (New Zealand) and EPSG:31466 are defined north first.
    for (const char* crs : {"EPSG:3857", "EPSG:2193"}) {
        const auto projection = Projection::create(crs);
        ASSERT_TRUE(projection.ok());
        const auto here = projection->plane({.longitude = 173, .latitude = -41});
        const auto east = projection->plane({.longitude = 173.1, .latitude = -41});
        ASSERT_TRUE(here.ok() && east.ok());
        EXPECT_GT(east->x - here->x, 8000) << crs;
        EXPECT_NEAR(east->y, here->y, 200) << crs;
    }
}

TEST(Projection, KnowsWhereNorthIs) {
    const auto utm = Projection::create("EPSG:32613");
    ASSERT_TRUE(utm.ok());
    EXPECT_NEAR(utm->gridHeadingOfNorth({500000, 4170000})->value(), 0, 1e-6);
    // West of the central meridian the meridians lean to the east: tan g = tan(dLon) sin(lat), to 1e-5 here.
    const auto place = utm->lonLat({450000, 4170000});
    const double expected =
        std::atan(std::tan((-105 - place->longitude) * M_PI / 180) * std::sin(place->latitude * M_PI / 180));
    EXPECT_GT(expected, 0);
    EXPECT_NEAR(utm->gridHeadingOfNorth({450000, 4170000})->value(), expected, 1e-5);

    const auto polar = Projection::create("EPSG:5041");
    ASSERT_TRUE(polar.ok());
    EXPECT_NEAR(polar->gridHeadingOfNorth({2000000, 1000000})->value(), 0, 1e-6);               // longitude 0
    EXPECT_NEAR(std::abs(polar->gridHeadingOfNorth({2000000, 3000000})->value()), M_PI, 1e-6);  // longitude 180
    EXPECT_TRUE(polar->gridHeadingOfNorth({2000000, 2000000}).ok());                            // the pole
}

TEST(Projection, DerivesTheGroundFromThePlane) {
    const auto utm = Projection::create("EPSG:32613");
    ASSERT_TRUE(utm.ok());
    const glm::dvec2 place(350000, 4170000);
    const auto ground = utm->groundFromPlane(place);
    ASSERT_TRUE(ground.ok());
    // Conformal: a turn by the convergence, and the scale of 0.9996 (1 + x^2 / 2 R^2).
    const double turn = utm->gridHeadingOfNorth(place)->value();
    const double scale = 0.9996 * (1 + 0.5 * std::pow(150000 / 6.373e6, 2));
    EXPECT_NEAR((*ground)[0].x, std::cos(turn) / scale, 2e-6);
    EXPECT_NEAR((*ground)[0].y, std::sin(turn) / scale, 2e-6);
    EXPECT_NEAR((*ground)[1].x, -std::sin(turn) / scale, 2e-6);
    EXPECT_NEAR((*ground)[1].y, std::cos(turn) / scale, 2e-6);

    // Not conformal: degrees of longitude are as wide as on the equator.
    const auto plateCarree = Projection::create("EPSG:4087");
    ASSERT_TRUE(plateCarree.ok());
    const auto stretched = plateCarree->groundFromPlane(plateCarree->plane({.longitude = 20, .latitude = 60}).value());
    ASSERT_TRUE(stretched.ok());
    EXPECT_NEAR((*stretched)[0].x, 0.5, 0.002);
    EXPECT_NEAR((*stretched)[1].y, 1, 0.005);
    // At the pole east is what it is on the meridian that PROJ gives it, but a metre stays a metre but for UPS's 0.994.
    const auto polar = Projection::create("EPSG:5041");
    ASSERT_TRUE(polar.ok());
    const auto pole = polar->groundFromPlane({2000000, 2000000});
    ASSERT_TRUE(pole.ok());
    EXPECT_NEAR(std::abs(glm::determinant(*pole)), 1 / (0.994 * 0.994), 1e-6);
    EXPECT_FALSE(utm->groundFromPlane({1e300, 1e9}).ok());
}

TEST(Projection, RefusesWhatItDoesNotKnow) {
    EXPECT_FALSE(Projection::create("EPSG:999999").ok());
    EXPECT_FALSE(Projection::create("no such thing").ok());
    EXPECT_FALSE(Projection::create("").ok());
    const auto projection = Projection::create("EPSG:32613");
    EXPECT_FALSE(projection->lonLat({1e300, 1e9}).ok());
    EXPECT_FALSE(projection->plane({.longitude = 0, .latitude = NAN}).ok());
}

#else

TEST(Projection, SaysThatThisBuildHasNone) {
    EXPECT_NE(Projection::create("EPSG:32613").failure().message.find("TERRAY_WITH_PROJ"), std::string::npos);
}

#endif

}  // namespace
}  // namespace terray
