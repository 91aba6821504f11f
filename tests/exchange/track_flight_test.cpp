// A track becomes a flight that keeps its way and time, looks ahead, and stays above the ground.

#include "client/exchange/track_flight.h"

#include <cmath>
#include <fstream>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "client/exchange/flight_files.h"
#include "tests/common/random.h"
#include "tests/common/temporary_directory.h"
#include "tests/support/analytic_dataset.h"

namespace terray::test {
namespace {

#if TERRAY_WITH_PROJ

class TrackFlight : public testing::Test {
  protected:
    /// A track of a way over the dataset's plane.
    template <class Way>
    Track trackOf(const Way& way, double seconds, double step, bool times = true) const {
        Track track{{{}}};
        for (double t = 0; t <= seconds; t += step) {
            const glm::dvec3 position = way(t);
            track.lines[0].push_back({.place = projection_.lonLat(glm::dvec2(position)).value(),
                                      .height = position.z,
                                      .seconds = times ? std::optional(5000 + t) : std::nullopt});
        }
        return track;
    }
    Flight fly(const Track& track, const TrackFlightOptions& options) {
        auto flight = flightAlong(track, options, projection_, ground_);
        EXPECT_TRUE(flight.ok()) << flight.failure().message;
        return std::move(*flight);
    }
    /// The dataset's ground as if it lay there.
    glm::dvec2 middle() const {
        const GroundRect ground = dataset_.metadata().groundBounds();
        return {(ground.west + ground.east) / 2, (ground.south + ground.north) / 2};
    }

    AnalyticDataset dataset_{{.finestLevel = 1, .imageryLevel = {}, .spacing = 8}};
    GroundHeights ground_{dataset_};
    // Its y axis is on the equator, so that small coordinates are places.
    Projection projection_ =
        Projection::create("+proj=tmerc +lon_0=9 +lat_0=0 +x_0=0 +y_0=0 +datum=WGS84 +type=crs").value();
};

TEST_F(TrackFlight, AStraightWayAtConstantSpeedIsFlownAsItIs) {
    const auto way = [](double t) { return glm::dvec3(40 * t, 30 * t, 5000 + 2 * t); };
    const Flight flight = fly(trackOf(way, 100, 1), {.lookDown = 5});
    EXPECT_NEAR(flight.seconds(), 100, 1e-6);
    for (double t = 1; t <= 99; t += 0.7) {  // at its ends the camera comes from rest
        const Camera camera = flight.at(t);
        EXPECT_LT(glm::distance(camera.position, way(t)), 1.0) << t;
        EXPECT_NEAR(camera.heading.value(), std::atan2(4, 3), 1e-3);
        EXPECT_NEAR(degreesFromRadians(camera.pitch), std::atan2(2, 50) * 180 / M_PI - 5, 0.05);
    }
    EXPECT_LT(glm::distance(flight.at(0).position, way(0)), 0.01);
    EXPECT_LT(glm::distance(flight.at(100).position, way(100)), 0.01);
}

TEST_F(TrackFlight, ItLooksIntoATurnBeforeItComes) {
    const auto way = [](double t) {
        return t < 50 ? glm::dvec3(30 * t, 0, 5000) : glm::dvec3(1500, 30 * (t - 50), 5000);
    };
    const Flight flight = fly(trackOf(way, 100, 1), {.lookAhead = 6});
    EXPECT_NEAR(flight.at(40).heading.value(), M_PI / 2, 0.01) << "east";
    EXPECT_LT(flight.at(47.5).heading.value(), M_PI / 2 - 0.3) << "the turn is 2.5 s ahead";
    EXPECT_NEAR(flight.at(60).heading.value(), 0, 0.01) << "north";
    EXPECT_LT(glm::distance(flight.at(50).position, way(50)), 30.0) << "the corner is cut a little";
}

TEST_F(TrackFlight, NoiseOfSingleFixesIsAveraged) {
    Random random(1);
    const auto way = [](double t) { return glm::dvec3(20 * t, 0, 5000); };
    const auto noisy = [&](double t) { return way(t) + glm::dvec3(0, random.between(-3, 3), random.between(-3, 3)); };
    const Flight flight = fly(trackOf(noisy, 200, 1), {.smoothing = 10});
    double worst = 0;
    for (double t = 10; t < 190; t += 0.3) worst = std::max(worst, std::abs(flight.at(t).position.y));
    EXPECT_LT(worst, 1.5);
}

TEST_F(TrackFlight, SpeedScalesTimeAndAWayWithoutTimesIsFlownAtOneSpeed) {
    const auto way = [](double t) { return glm::dvec3(t < 10 ? t : 10 + 9 * (t - 10), 0, 5000); };
    EXPECT_NEAR(fly(trackOf(way, 20, 1), {.speed = 4}).seconds(), 5, 1e-6);
    const Flight even = fly(trackOf(way, 20, 1, false), {.metresPerSecond = 20});
    EXPECT_NEAR(even.seconds(), 5, 1e-6);
    EXPECT_NEAR(glm::distance(even.at(2).position, even.at(3).position), 20, 0.1);
}

TEST_F(TrackFlight, ItKeepsItsClearanceAboveTheGround) {
    const glm::dvec2 start = middle() - glm::dvec2(2000, 1000);
    const auto way = [&](double t) { return glm::dvec3(start + t * glm::dvec2(20, 10), -500); };  // a tunnel
    const Flight flight = fly(trackOf(way, 200, 2), {.clearance = 35});
    for (double t = 0; t <= 200; t += 0.1) {
        const glm::dvec3 eye = flight.at(t).position;
        const auto ground = ground_.at(glm::dvec2(eye));
        ASSERT_TRUE(ground.has_value()) << t;
        // Between checks at 30 a second the eye goes 0.75 m, and a cell's step beside it may be 1.2 times 8 m.
        EXPECT_GT(eye.z, *ground + 35 - 1.2 * 8) << t;
    }
}

TEST_F(TrackFlight, FixesWithoutHeightAreOnTheGround) {
    Track track = trackOf([&](double t) { return glm::dvec3(middle() + glm::dvec2(10 * t, 0), 0); }, 20, 1);
    for (TrackPoint& point : track.lines[0]) point.height.reset();
    const Flight flight = fly(track, {.above = 100, .clearance = 1});
    EXPECT_NEAR(flight.at(0).position.z, *ground_.at(middle()) + 100, 15);
}

TEST_F(TrackFlight, OneFixIsNoWay) {
    const auto still = [](double) { return glm::dvec3(0, 0, 100); };
    EXPECT_FALSE(flightAlong(trackOf(still, 0, 1), {}, projection_, ground_).ok());
    EXPECT_FALSE(flightAlong(trackOf(still, 5, 1, false), {}, projection_, ground_).ok());
    const auto far = [](double t) { return glm::dvec3(t, 0, 100); };
    EXPECT_NE(
        flightAlong(trackOf(far, 1e6, 1e5), {.smoothing = 1}, projection_, ground_).failure().message.find("keys"),
        std::string::npos);
}

TEST_F(TrackFlight, AFlightWrittenAsGpxComesBackAsItsWay) {
    if (!TERRAY_WITH_TRACKS) return;
    const auto way = [](double t) { return glm::dvec3(40 * t, 100 * std::sin(t / 10), 5000); };
    const Flight flight = fly(trackOf(way, 60, 1), {});
    const TemporaryDirectory directory;
    exportFlight(flight, directory / "way.gpx", &projection_);
    const Flight back = importFlight(directory / "way.gpx", {.smoothing = 0.5}, &projection_, ground_);
    EXPECT_NEAR(back.seconds(), flight.seconds(), 1e-3);
    for (double t = 1; t < 59; t += 0.37)
        EXPECT_LT(glm::distance(back.at(t).position, flight.at(t).position), 1.0) << t;
}

TEST_F(TrackFlight, AGliderLogIsFlownAtItsTimes) {
    // B records: time, latitude, longitude, validity, barometric and GNSS height. Two minutes over midnight.
    const TemporaryDirectory directory;
    std::ofstream(directory / "log.igc") << "AXXX001\r\nHFDTE311224\r\n"
                                            "B2359000000000N00900000EA0800008000\r\n"
                                            "B2359300000500N00900000EA0805008050\r\n"
                                            "B0000000001000N00900000EA0810008100\r\n"
                                            "B0001000002000N00900000EA0820008200\r\n";
    const Flight flight = importFlight(directory / "log.igc", {.speed = 2}, &projection_, ground_);
    EXPECT_NEAR(flight.seconds(), 60, 1e-6);
    EXPECT_EQ(flight.name, "log");
    EXPECT_NEAR(flight.at(0).position.z, 8000, 0.1);
    EXPECT_NEAR(flight.at(60).position.z, 8200, 0.1);
    EXPECT_NEAR(flight.at(30).position.y, 1843, 5) << "a minute of latitude in 60 s";
    EXPECT_NEAR(flight.at(30).heading.value(), 0, 1e-3);
}

#endif

}  // namespace
}  // namespace terray::test
