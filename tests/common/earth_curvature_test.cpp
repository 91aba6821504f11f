#include "common/earth_curvature.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/common/random.h"

namespace terray {
namespace {

constexpr double kA = 6378137.0;          // WGS 84, metres: equatorial radius
constexpr double kE2 = 6.69437999014e-3;  // eccentricity squared
constexpr Sight kStill{.eyeHeight = 0, .refraction = 0};

/// Euler's radius by the textbook formulas.
double radius(double latitude, double azimuth) {
    const double w = std::sqrt(1 - kE2 * std::pow(std::sin(latitude), 2));
    const double meridian = kA * (1 - kE2) / (w * w * w), primeVertical = kA / w;
    return 1 / (std::pow(std::cos(azimuth), 2) / meridian + std::pow(std::sin(azimuth), 2) / primeVertical);
}

/// A conformal map on which true north lies `turn` clockwise of the y axis.
glm::dmat2 conformal(double turn, double scale) {
    return glm::dmat2(std::cos(turn), std::sin(turn), -std::sin(turn), std::cos(turn)) / scale;
}

TEST(EarthCurvature, IsEulersFormulaTurnedAndScaledIntoTheMap) {
    for (const double latitude : {-80.0, -30.0, 0.0, 45.0, 90.0})
        for (const double turn : {0.0, 0.02, -0.7, 2.5})
            for (const double scale : {1.0, 0.9996, 2.0}) {
                const EarthCurvature earth = earthCurvature(latitude, conformal(turn, scale), kStill);
                for (int degrees = 0; degrees < 360; degrees += 30) {
                    // A line of 1000 m; its true azimuth is its heading on the grid less the turn.
                    const double heading = degrees * M_PI / 180;
                    const glm::dvec2 onMap = 1000 * scale * glm::dvec2(std::sin(heading), std::cos(heading));
                    const double expected = 1e6 / (2 * radius(latitude * M_PI / 180, heading - turn));
                    EXPECT_NEAR(earth.drop(onMap), expected, 1e-9) << latitude << ' ' << turn << ' ' << degrees;
                }
            }
}

TEST(EarthCurvature, FallsByTheSurveyorsRule) {
    // 7.8 cm on the first kilometre, 28 km over 600; refraction takes 13 % off.
    const EarthCurvature earth = sphericalEarth(kStill);
    EXPECT_NEAR(earth.drop(1000, 0), 0.0785, 1e-4);
    EXPECT_NEAR(earth.drop(0, 600e3), 28253, 1);
    const EarthCurvature air = sphericalEarth({.eyeHeight = 0});
    EXPECT_NEAR(air.drop(0, 600e3), 0.87 * 28253, 1);
    EXPECT_EQ(EarthCurvature().drop(5, 7), 0);
}

TEST(EarthCurvature, DipsTheHorizonAsOnASphereWhateverTheHeight) {
    constexpr double kR = 6371008.8;
    for (const double height : {0.0, 2.0, 12e3, 400e3, 36e6}) {
        const EarthCurvature earth = sphericalEarth({.eyeHeight = height, .refraction = 0});
        // z(d) = h + d tan e + form d^2 touches 0 where its discriminant vanishes.
        const double slope = 2 * std::sqrt(height * earth.yy);
        EXPECT_NEAR(std::atan(slope), std::acos(kR / (kR + height)), 1e-9) << height;
    }
    // An eye under the sea sees as from its surface.
    EXPECT_EQ(sphericalEarth({.eyeHeight = -400}), sphericalEarth({.eyeHeight = 0}));
}

TEST(EarthCurvatureDeathTest, RefusesLightThatBendsAsTheEarth) {
    EXPECT_DEATH((void)sphericalEarth({.eyeHeight = 0, .refraction = 1}), "refraction");
    EXPECT_DEATH((void)sphericalEarth({.eyeHeight = 0, .refraction = NAN}), "refraction");
}

TEST(EarthCurvature, BoundsTheDropOverAnyRectangle) {
    test::Random random(7);
    for (int round = 0; round < 300; ++round) {
        // Any positive definite form: axes of 1 and 0.05 .. 1, turned at will.
        const double narrow = random.between(0.05, 1), turn = random.between(0, 3.2);
        const double c = std::cos(turn), s = std::sin(turn);
        const EarthCurvature earth{c * c + narrow * s * s, 2 * c * s * (1 - narrow), s * s + narrow * c * c};
        const glm::dvec2 eye(random.between(-5, 5), random.between(-5, 5));
        const double west = random.between(-5, 5), south = random.between(-5, 5);
        const GroundRect ground{west, south, west + random.between(0, 4), south + random.between(0, 4)};
        const DropRange range = dropOver(earth, ground, eye);
        double least = INFINITY, greatest = 0;
        constexpr int kSteps = 100;
        for (int i = 0; i <= kSteps; ++i)
            for (int j = 0; j <= kSteps; ++j) {
                const double drop = earth.drop(ground.west + (ground.east - ground.west) * i / kSteps - eye.x,
                                               ground.south + (ground.north - ground.south) * j / kSteps - eye.y);
                least = std::min(least, drop);
                greatest = std::max(greatest, drop);
            }
        EXPECT_LE(range.least, least + 1e-12);
        EXPECT_NEAR(range.least, least, 0.02 + 0.02 * least);  // the samples are up to 0.02 from the lowest point
        EXPECT_NEAR(range.greatest, greatest, 1e-12 * greatest);
    }
}

TEST(EarthCurvature, DropsNothingWhereTheEyeIs) {
    const EarthCurvature earth = sphericalEarth(kStill);
    const GroundRect ground{0, 0, 100e3, 50e3};
    EXPECT_EQ(dropOver(earth, ground, {20e3, 30e3}).least, 0);
    EXPECT_EQ(dropOver(earth, ground, {0, 50e3}).least, 0);
    EXPECT_EQ(dropOver(EarthCurvature(), ground, {-1e6, 0}).greatest, 0);
    EXPECT_DOUBLE_EQ(dropOver(earth, ground, {-10e3, 20e3}).least, earth.drop(10e3, 0));
    EXPECT_DOUBLE_EQ(dropOver(earth, ground, {-10e3, 20e3}).greatest, earth.drop(110e3, 30e3));
}

#if TERRAY_WITH_PROJ

TEST(EarthCurvature, ComesFromThePlaceOfTheMap) {
    const auto utm = Projection::create("EPSG:32632");
    const auto mercator = Projection::create("EPSG:3857");
    ASSERT_TRUE(utm.ok() && mercator.ok());
    const LonLat place{.longitude = 9, .latitude = 60};  // UTM's central meridian
    const auto inUtm = earthCurvature(*utm, utm->plane(place).value(), kStill);
    const auto inMercator = earthCurvature(*mercator, mercator->plane(place).value(), kStill);
    ASSERT_TRUE(inUtm.ok() && inMercator.ok());
    const double scale = 0.9996;
    EXPECT_NEAR(inUtm->xx * scale * scale, 0.5 / radius(M_PI / 3, M_PI / 2), 1e-14);
    EXPECT_NEAR(inUtm->yy * scale * scale, 0.5 / radius(M_PI / 3, 0), 1e-14);
    EXPECT_NEAR(inUtm->xy, 0, 1e-14);
    // Mercator at 60 degrees: a metre of the map is half a metre, its drop a quarter.
    EXPECT_NEAR(inMercator->xx / inUtm->xx, 0.25, 0.002);
    EXPECT_FALSE(earthCurvature(*utm, {1e300, 1e9}, kStill).ok());
}

#endif

}  // namespace
}  // namespace terray
