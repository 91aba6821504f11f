#include "common/sun_position.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "common/utc_time.h"

namespace terray {
namespace {

UtcTime at(const std::string& text) {
    const Result<UtcTime> time = parseUtcTime(text);
    EXPECT_TRUE(time.ok()) << text;
    return time.ok() ? *time : UtcTime();
}

double degrees(Radians angle) {
    return degreesFromRadians(angle);
}

/// Angle between two directions, degrees.
double between(const glm::dvec3& a, const glm::dvec3& b) {
    return degreesFromRadians(Radians(2 * std::asin(std::min(1.0, glm::length(a - b) / 2))));
}

SunAngles angles(double azimuth, double elevation) {
    return {.azimuth = radiansFromDegrees(azimuth), .elevation = radiansFromDegrees(elevation)};
}

// What the header promises, without and with UTC's distance from the earth's turning.
constexpr double kSphereBound = 0.011;
constexpr double kGroundBound = 0.015;

TEST(UtcTime, ReadsIso8601) {
    using namespace std::chrono;
    const UtcTime noon = sys_days(year(2026) / 6 / 21) + hours(12);
    EXPECT_EQ(at("2026-06-21T12:00Z"), noon);
    EXPECT_EQ(at("2026-06-21T12:00:00Z"), noon);
    EXPECT_EQ(at("2026-06-21T14:00+02:00"), noon);
    EXPECT_EQ(at("2026-06-21T02:30:00.0-09:30"), noon);
    EXPECT_EQ(at("2026-06-22T02:00+14:00"), noon);
    EXPECT_EQ(at("2026-06-21T12:00:30.5Z"), noon + milliseconds(30500));
    EXPECT_EQ(at("2026-06-21T12:00:00.007Z"), noon + milliseconds(7));
    EXPECT_EQ(at("1970-01-01T00:00Z").time_since_epoch().count(), 0);
    // Leap years, and an offset that leads into another year.
    EXPECT_EQ(at("2024-02-29T00:00Z"), UtcTime(sys_days(year(2024) / 3 / 1) - hours(24)));
    EXPECT_EQ(at("2000-02-29T00:00Z"), UtcTime(sys_days(year(2000) / 3 / 1) - hours(24)));
    EXPECT_EQ(at("2025-12-31T23:00-02:00"), UtcTime(sys_days(year(2026) / 1 / 1) + hours(1)));
}

TEST(UtcTime, RefusesEverythingElse) {
    for (const char* text : {"",
                             "noon",
                             "2026-06-21",
                             "2026-06-21T12Z",
                             "2026-06-21T12:00",
                             "2026-06-21 12:00Z",
                             "2026-6-21T12:00Z",
                             "26-06-21T12:00Z",
                             "2026-06-21t12:00z",
                             "2026-06-21T12:00Z ",
                             " 2026-06-21T12:00Z",
                             "+2026-06-21T12:00Z",
                             "2026-02-29T12:00Z",
                             "1900-02-29T12:00Z",
                             "2026-04-31T12:00Z",
                             "2026-00-10T12:00Z",
                             "2026-13-10T12:00Z",
                             "2026-06-00T12:00Z",
                             "1899-12-31T12:00Z",
                             "2101-01-01T12:00Z",
                             "2026-06-21T24:00Z",
                             "2026-06-21T12:60Z",
                             "2016-12-31T23:59:60Z",
                             "2026-06-21T12:00:Z",
                             "2026-06-21T12:00:00.Z",
                             "2026-06-21T12:00:00.1234Z",
                             "2026-06-21T12:00:00,5Z",
                             "2026-06-21T12:00+2",
                             "2026-06-21T12:00+0200",
                             "2026-06-21T12:00+14:01",
                             "2026-06-21T12:00-00:00",
                             "2026-06-21T12:00+02:60",
                             "2026-06-21T12:00Z+02:00",
                             "2026-06-21T1\xd9\xa2:00Z"})
        EXPECT_FALSE(parseUtcTime(text).ok()) << text;
}

TEST(UtcTime, SaysWhatIsWrong) {
    const auto why = [](const char* text) { return parseUtcTime(text).failure().message; };
    EXPECT_NE(why("2026-06-21T12:00").find("no zone"), std::string::npos);
    EXPECT_NE(why("2025-02-29T12:00Z").find("no such day"), std::string::npos);
    EXPECT_NE(why("2026-06-21T25:00Z").find("no such time"), std::string::npos);
    EXPECT_NE(why("2200-06-21T25:00Z").find("1900 to 2100"), std::string::npos);
}

TEST(UtcTime, EveryTruncationIsRefused) {
    const std::string whole = "2026-06-21T14:00:30.5+02:00";
    for (size_t n = 0; n < whole.size(); ++n) EXPECT_FALSE(parseUtcTime(whole.substr(0, n)).ok()) << n;
    EXPECT_TRUE(parseUtcTime(whole).ok());
}

TEST(SunPosition, FollowsMeeusExample25a) {
    // 1992 October 13.0 of dynamical time, 59 s ahead of UTC then: right ascension 198.38083, declination -7.78507,
    // distance 0.99766 (Meeus 1998, example 25.a). His is the same method, so only the clocks' 10 s are between us.
    const SunEquatorial sun = sunEquatorial(at("1992-10-12T23:59:01Z"));
    EXPECT_NEAR(degrees(sun.rightAscension), 198.38083, 0.0002);
    EXPECT_NEAR(degrees(sun.declination), -7.78507, 0.0001);
    EXPECT_NEAR(sun.distance, 0.99766, 1e-5);
}

TEST(SunPosition, AgreesWithTheSolarPositionAlgorithm) {
    // Reda and Andreas 2008, NREL/TP-560-34302, appendix A.5: elevation without refraction 39.872046 and azimuth
    // 194.340241 (topocentric; the observer's 1830 m do not show at this precision).
    const SunAngles sun = sunAngles(at("2003-10-17T12:30:30-07:00"), {-105.1786, 39.742476}, Refraction::none);
    EXPECT_LT(between(directionOf(sun), directionOf(angles(194.340241, 39.872046))), kGroundBound);
    // Seen through the thinner air of 1830 m, 820 hPa, it is at 39.888378; the standard air lifts it by a fifth more.
    const SunAngles lifted = sunAngles(at("2003-10-17T12:30:30-07:00"), {-105.1786, 39.742476});
    EXPECT_NEAR(degrees(lifted.elevation), 39.888378, kGroundBound);
    EXPECT_NEAR(degrees(lifted.elevation - sun.elevation), 0.0163 * 1010 / 820, 0.001);
}

TEST(SunPosition, AgreesWithErfa) {
    struct Known {
        const char* time;
        LonLat place;
        double azimuth, elevation;
    };
    // Azimuth and elevation without refraction, by ERFA 2.0.0: epv00, ab, pnm06a, gst06a, WGS 84, UT1 taken as UTC.
    for (const Known& known :
         std::initializer_list<Known>{{"1905-07-03T05:12:40Z", {-0.1278, 51.5074}, 65.7320, 10.2598},
                                      {"1936-02-29T23:59:59Z", {139.6917, 35.6895}, 127.8062, 30.3769},
                                      {"1969-07-20T20:17:40Z", {-80.6, 28.5}, 268.0272, 50.9652},
                                      {"1987-12-22T09:49:00Z", {174.7787, -41.2924}, 215.6739, -16.4997},
                                      {"2000-01-01T12:00:00Z", {0, 0}, 178.0689, 66.9528},
                                      {"2004-06-08T08:20:00Z", {31.2357, 30.0444}, 103.1980, 67.8050},
                                      {"2016-03-20T04:30:00Z", {-70, -90}, 184.3586, -0.0022},
                                      {"2016-06-20T22:34:00Z", {25, 66.5}, 2.8097, -0.0378},
                                      {"2024-12-21T09:20:00Z", {-68.3, -54.8}, 117.7372, 9.3692},
                                      {"2026-06-21T12:00:00Z", {7.9851, 46.5475}, 197.2711, 66.1074},
                                      {"2050-09-22T18:00:00Z", {-179.9, -17}, 89.4056, 1.8590},
                                      {"2099-12-31T23:00:00Z", {-105.1, 39.7}, 232.6608, 6.5382}}) {
        const SunAngles sun = sunAngles(at(known.time), known.place, Refraction::none);
        EXPECT_LT(between(directionOf(sun), directionOf(angles(known.azimuth, known.elevation))), kGroundBound)
            << known.time;
    }
}

TEST(SunPosition, CrossesTheEquatorAndTurnsWhenTheAlmanacSays) {
    // Equinoxes and solstices of 2026 (to the minute). An equinox is where apparent longitude is 0 or 180 degrees.
    EXPECT_NEAR(degrees(sunEquatorial(at("2026-03-20T14:46Z")).declination), 0, kSphereBound * std::sin(0.41));
    EXPECT_NEAR(degrees(sunEquatorial(at("2026-09-23T00:05Z")).declination), 0, kSphereBound * std::sin(0.41));
    // At a solstice declination is the obliquity of the date: 23.4358 degrees (mean 23.4360 in 2026, nutation's
    // 0.0024).
    EXPECT_NEAR(degrees(sunEquatorial(at("2026-06-21T08:24Z")).declination), 23.436, 0.003);
    EXPECT_NEAR(degrees(sunEquatorial(at("2026-12-21T20:50Z")).declination), -23.436, 0.003);
    EXPECT_NEAR(degrees(sunEquatorial(at("2026-06-21T08:24Z")).rightAscension), 90, kSphereBound);
    EXPECT_NEAR(degrees(sunEquatorial(at("2026-12-21T20:50Z")).rightAscension), 270, kSphereBound);
}

TEST(SunPosition, StandsOverhead) {
    // Where declination is the latitude and the hour angle is 0: find the place from the sun seen at the north pole.
    const UtcTime when = at("2026-05-04T15:10Z");
    const SunAngles fromPole = sunAngles(when, {0, 90}, Refraction::none);
    // At the pole "north" is along the meridian of 180 degrees, so azimuth 180 is that of Greenwich.
    const LonLat below{.longitude = 180 - degrees(fromPole.azimuth),
                       .latitude = degrees(sunEquatorial(when).declination)};
    EXPECT_NEAR(degrees(sunAngles(when, below, Refraction::none).elevation), 90, 1e-6);
    EXPECT_NEAR(degrees(sunAngles(when, below).elevation), 90, 1e-6);
    // A degree to the north of there the sun is a degree from the zenith, due south, and a degree to the east due west.
    const SunAngles north = sunAngles(when, {below.longitude, below.latitude + 1}, Refraction::none);
    EXPECT_NEAR(degrees(north.elevation), 89, 1e-4);
    EXPECT_NEAR(degrees(north.azimuth), 180, 1e-6);
    const SunAngles east = sunAngles(when, {below.longitude + 1, below.latitude}, Refraction::none);
    EXPECT_NEAR(degrees(east.azimuth), 270, 0.5);
}

TEST(SunPosition, AirLiftsTheSunSmoothly) {
    // At the horizon by about 29 arc minutes (true -0.5 seen at about 0), at 10 degrees by 5.4, overhead by nothing.
    const LonLat place{8, 46};
    const UtcTime start = at("2026-09-23T00:00Z");
    double lastSeen = 0;
    double lastTrue = 0;
    bool horizonSeen = false;
    for (int second = 0; second < 86400 / 2; second += 20) {
        const UtcTime when = start + std::chrono::seconds(second);
        const double elevation = degrees(sunAngles(when, place, Refraction::none).elevation);
        const double seen = degrees(sunAngles(when, place).elevation);
        ASSERT_GE(seen, elevation);
        ASSERT_LT(seen - elevation, 0.7);
        ASSERT_TRUE(elevation >= -3 || seen == elevation) << elevation;
        ASSERT_TRUE(elevation <= 15 || seen - elevation < 0.062) << elevation;
        // Neither stands still nor jumps.
        const double rate = second == 0 ? 1 : (seen - lastSeen) / (elevation - lastTrue);
        ASSERT_GT(rate, 0.5) << elevation;
        ASSERT_LT(rate, 1.5) << elevation;
        if (std::abs(elevation + 0.5) < 0.05) {
            EXPECT_NEAR(seen, 0.0, 0.12);
            horizonSeen = true;
        }
        lastSeen = seen;
        lastTrue = elevation;
        if (degrees(sunAngles(when, place).azimuth) > 178) break;  // noon: from here it sinks
    }
    EXPECT_TRUE(horizonSeen);
}

TEST(SunPosition, IsTheSameOnBothSidesOfTheSeamAndAtThePoles) {
    const UtcTime when = at("2026-06-21T12:00Z");
    EXPECT_LT(between(directionOf(sunAngles(when, {180, 10})), directionOf(sunAngles(when, {-180, 10}))), 1e-9);
    for (const double latitude : {-90.0, 90.0}) {
        const SunAngles sun = sunAngles(when, {12, latitude}, Refraction::none);
        // There elevation is declination, less the parallax of somebody at right angles to it (Meeus, chapter 40).
        const SunEquatorial centre = sunEquatorial(when);
        const double parallax = 8.794 / 3600 / centre.distance * std::cos(centre.declination.value());
        EXPECT_NEAR(degrees(sun.elevation), std::copysign(degrees(centre.declination), latitude) - parallax, 1e-6);
        EXPECT_TRUE(std::isfinite(sun.azimuth.value()));
    }
}

TEST(SunPositionDeathTest, StopsOnPlacesOffTheEarth) {
    EXPECT_DEATH((void)sunAngles(UtcTime(), {0, 91}), "latitude");
}

#if TERRAY_WITH_PROJ

TEST(SunPosition, IsTurnedIntoTheGrid) {
    const UtcTime when = at("2026-06-21T14:30Z");
    const auto projection = Projection::create("EPSG:32632");  // central meridian 9 E
    ASSERT_TRUE(projection.ok());
    const LonLat place{.longitude = 11.5, .latitude = 47};
    const auto plane = projection->plane(place);
    ASSERT_TRUE(plane.ok());
    const auto found = gridSunDirection(when, *projection, *plane);
    ASSERT_TRUE(found.ok());
    // Grid convergence on the sphere: tan(c) = tan(longitude from the central meridian) sin(latitude); true north lies
    // that far to the left of grid north when the place lies to the east.
    const double convergence =
        std::atan(std::tan(radiansFromDegrees(2.5).value()) * std::sin(radiansFromDegrees(47).value()));
    EXPECT_GT(convergence, radiansFromDegrees(1.8).value());
    SunAngles expected = sunAngles(when, place);
    expected.azimuth = expected.azimuth - Radians(convergence);
    EXPECT_LT(between(*found, directionOf(expected)), 0.002);  // the ellipsoid's convergence differs by 0.001 degrees
    EXPECT_NEAR(glm::length(*found), 1, 1e-12);
}

TEST(SunPosition, FailsWhereTheProjectionDoes) {
    const auto projection = Projection::create("EPSG:32632");
    ASSERT_TRUE(projection.ok());
    EXPECT_FALSE(gridSunDirection(at("2026-06-21T12:00Z"), *projection, {1e30, 1e30}).ok());
}

#endif

}  // namespace
}  // namespace terray
