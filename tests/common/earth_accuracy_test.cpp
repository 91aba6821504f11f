// How far the parabola of common/earth_curvature.h lies from exact geodesy. Prints the table of tests/bench/REPORT.md,
// section "Curved earth":  terray_common_tests --gtest_filter='EarthAccuracy.*'

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/Geodesic.hpp>
#include <gtest/gtest.h>

#include "common/earth_curvature.h"

namespace terray {
namespace {

constexpr double kArcseconds = 180 * 3600 / M_PI;
constexpr std::array kLatitudes{0.0, 45.0, 70.0};
constexpr std::array kAzimuths{0.0, 45.0, 90.0, 200.0};
constexpr std::array kEyeHeights{2.0, 100.0, 1500.0, 12000.0};
constexpr std::array kTargetHeights{0.0, 1000.0, 4000.0, 8000.0};
constexpr std::array kRefractions{0.0, kStandardRefraction};

/// A line of sight: degrees and metres.
struct Line {
    double latitude = 0;
    double longitude = 0;
    double azimuth = 0;
    double distance = 0;  ///< along the geodesic
    double eyeHeight = 0;
    double targetHeight = 0;
    double refraction = 0;
};

LonLat targetOf(const Line& line) {
    LonLat target;
    GeographicLib::Geodesic::WGS84().Direct(line.latitude, line.longitude, line.azimuth, line.distance, target.latitude,
                                            target.longitude);
    return target;
}

/// Tangent of the apparent elevation by geocentric coordinates. Refraction: straight lines over an earth whose radii
/// are 1 / (1 - k) as large, with distances and heights as they are, which is this earth with those shrunk.
double exactSlope(const Line& line) {
    const double shrunk = 1 - line.refraction;
    Line small = line;
    small.distance *= shrunk;
    const LonLat target = targetOf(small);
    const GeographicLib::Geocentric& earth = GeographicLib::Geocentric::WGS84();
    glm::dvec3 eye, there;
    earth.Forward(line.latitude, line.longitude, line.eyeHeight * shrunk, eye.x, eye.y, eye.z);
    earth.Forward(target.latitude, target.longitude, line.targetHeight * shrunk, there.x, there.y, there.z);
    const double phi = line.latitude * M_PI / 180, lambda = line.longitude * M_PI / 180;
    const glm::dvec3 way = there - eye;
    const double outward = std::cos(lambda) * way.x + std::sin(lambda) * way.y;
    const double east = std::cos(lambda) * way.y - std::sin(lambda) * way.x;
    const double north = std::cos(phi) * way.z - std::sin(phi) * outward;
    return (std::cos(phi) * outward + std::sin(phi) * way.z) / std::hypot(east, north);
}

Sight sightOf(const Line& line) {
    return {.eyeHeight = line.eyeHeight, .refraction = line.refraction};
}

/// Tangent of the elevation at which a flat map shows a target by bent rays.
double mapSlope(const Line& line, const EarthCurvature& earth, glm::dvec2 displacement) {
    const double rise = line.targetHeight - line.eyeHeight - earth.drop(displacement);
    return rise / std::hypot(displacement.x, displacement.y);
}

/// Arcseconds by which the map's elevation is too great, on a map that keeps distances and azimuths from the eye.
double elevationError(const Line& line) {
    const double azimuth = line.azimuth * M_PI / 180;
    const glm::dvec2 displacement = line.distance * glm::dvec2(std::sin(azimuth), std::cos(azimuth));
    const EarthCurvature earth = earthCurvature(line.latitude, glm::dmat2(1), sightOf(line));
    return kArcseconds * (std::atan(mapSlope(line, earth, displacement)) - std::atan(exactSlope(line)));
}

template <class Visit>
void forEachPlace(const Visit& visit) {
    for (const double refraction : kRefractions)
        for (const double latitude : kLatitudes)
            for (const double azimuth : kAzimuths)
                for (const double eyeHeight : kEyeHeights)
                    visit(Line{.latitude = latitude,
                               .longitude = 10.5,
                               .azimuth = azimuth,
                               .eyeHeight = eyeHeight,
                               .refraction = refraction});
}

template <class Visit>
void forEachLine(double distance, const Visit& visit) {
    forEachPlace([&](Line line) {
        line.distance = distance;
        for (const double targetHeight : kTargetHeights) {
            line.targetHeight = targetHeight;
            visit(line);
        }
    });
}

/// Bounds in arcseconds at a distance. common/earth_curvature.h states them.
struct Row {
    double distance;
    double any;
    double grazing;  ///< lines within 10 degrees of the horizontal
    double utm;      ///< the same on a map in UTM
};

constexpr std::array<Row, 7> kRows{{{1e3, 62, 1, 8},
                                    {3e3, 126, 6, 18},
                                    {10e3, 128, 4, 12},
                                    {30e3, 65, 35, 45},
                                    {100e3, 21, 21, 26},
                                    {300e3, 8, 8, 11},
                                    {600e3, 11, 11, 28}}};

bool isGrazing(const Line& line) {
    return std::abs(exactSlope(line)) <= std::tan(10 * M_PI / 180);
}

TEST(EarthAccuracy, ElevationAnglesKeepTheStatedBound) {
    std::printf(
        "distance, km | elevation, worst error in arcseconds: any line | within 10 degrees of the horizontal\n");
    for (const Row& row : kRows) {
        double worst = 0, worstGrazing = 0;
        int grazing = 0;
        forEachLine(row.distance, [&](const Line& line) {
            const double error = std::abs(elevationError(line));
            worst = std::max(worst, error);
            if (!isGrazing(line)) return;
            ++grazing;
            worstGrazing = std::max(worstGrazing, error);
        });
        std::printf("%12g | %56.1f | %6.1f (%d lines)\n", row.distance / 1e3, worst, worstGrazing, grazing);
        EXPECT_LE(worst, row.any) << row.distance;
        EXPECT_LE(worstGrazing, row.grazing) << row.distance;
        EXPECT_GE(worst, 0.8 * row.any) << "the stated bound is not of this table any more";
        EXPECT_GE(grazing, 48);
    }
}

/// The distance along the geodesic, metres, at which the sea (height 0) looks highest, and the elevation there.
struct Horizon {
    double distance;
    double slope;
};

Horizon exactHorizon(Line line, double guess) {
    // Golden section: the elevation of the sea rises up to the horizon and falls beyond it.
    const double golden = (std::sqrt(5.0) - 1) / 2;
    double low = 0.5 * guess, high = 1.5 * guess;
    const auto slopeAt = [&](double distance) {
        line.distance = distance;
        return exactSlope(line);
    };
    while (high - low > 1e-3) {
        const double a = high - golden * (high - low), b = low + golden * (high - low);
        (slopeAt(a) < slopeAt(b) ? low : high) = slopeAt(a) < slopeAt(b) ? a : b;
    }
    return {low, slopeAt(low)};
}

TEST(EarthAccuracy, TheHorizonKeepsTheStatedBound) {
    struct Bound {
        double metres;
        double arcseconds;
    };
    constexpr std::array<Bound, kEyeHeights.size()> kBounds{{{0.2, 0.02}, {1, 0.02}, {16, 0.2}, {200, 1.4}}};
    std::printf("eye, m | horizon, km | worst error: of its distance, m | of its dip, arcseconds\n");
    std::array<double, kEyeHeights.size()> metres{}, arcseconds{}, kilometres{};
    forEachPlace([&](const Line& line) {
        const size_t row = static_cast<size_t>(std::find(kEyeHeights.begin(), kEyeHeights.end(), line.eyeHeight) -
                                               kEyeHeights.begin());
        const double azimuth = line.azimuth * M_PI / 180;
        const EarthCurvature earth = earthCurvature(line.latitude, glm::dmat2(1), sightOf(line));
        const double form = earth.drop(std::sin(azimuth), std::cos(azimuth));
        // z(d) = h + d tan e + form d^2 touches 0 at the double root.
        const Horizon map{std::sqrt(line.eyeHeight / form), -2 * std::sqrt(line.eyeHeight * form)};
        const Horizon exact = exactHorizon(line, map.distance);
        kilometres[row] = std::max(kilometres[row], exact.distance / 1e3);
        metres[row] = std::max(metres[row], std::abs(map.distance - exact.distance));
        arcseconds[row] =
            std::max(arcseconds[row], kArcseconds * std::abs(std::atan(map.slope) - std::atan(exact.slope)));
    });
    for (size_t row = 0; row < kEyeHeights.size(); ++row) {
        std::printf("%6g | %11.1f | %31.1f | %22.2f\n", kEyeHeights[row], kilometres[row], metres[row],
                    arcseconds[row]);
        EXPECT_LE(metres[row], kBounds[row].metres) << kEyeHeights[row];
        EXPECT_LE(arcseconds[row], kBounds[row].arcseconds) << kEyeHeights[row];
    }
}

#if TERRAY_WITH_PROJ

TEST(EarthAccuracy, AMapProjectionAddsLittle) {
    // The eye 1.5 degrees east of the central meridian: half-way to the edge of its zone.
    std::printf("distance, km | elevation in UTM, worst error in arcseconds: within 10 degrees of the horizontal\n");
    const auto utm = Projection::create("EPSG:32632");
    ASSERT_TRUE(utm.ok());
    for (const Row& row : kRows) {
        double worst = 0;
        forEachLine(row.distance, [&](const Line& line) {
            if (!isGrazing(line)) return;
            const auto eye = utm->plane({line.longitude, line.latitude});
            const auto target = utm->plane(targetOf(line));
            ASSERT_TRUE(eye.ok() && target.ok());
            const auto earth = earthCurvature(*utm, *eye, sightOf(line));
            ASSERT_TRUE(earth.ok());
            const double error = std::atan(mapSlope(line, *earth, *target - *eye)) - std::atan(exactSlope(line));
            worst = std::max(worst, kArcseconds * std::abs(error));
        });
        std::printf("%12g | %6.1f\n", row.distance / 1e3, worst);
        EXPECT_LE(worst, row.utm) << row.distance;
    }
}

#endif

}  // namespace
}  // namespace terray
