// KML tours: ours come back as they were, those of other programs are flown as they say, broken ones are told apart.

#include <algorithm>
#include <cmath>
#include <fstream>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "client/exchange/flight_files.h"
#include "client/stream/flight_editing.h"
#include "common/error.h"
#include "tests/common/random.h"
#include "tests/common/temporary_directory.h"
#include "tests/support/analytic_dataset.h"

namespace terray::test {
namespace {

TEST(Kml, ATourComesBackAsItWas) {
    const KmlTour tour{
        .name = "a < b & \"c\"",
        .steps = {
            {.seconds = 2.5,
             .view = KmlView{.place = {-105.5, 37.25},
                             .altitude = 4321.125,
                             .mode = KmlAltitude::absolute,
                             .heading = 12.75,
                             .tilt = 80,
                             .horizontalFov = 60.5},
             .smooth = true},
            {.seconds = 1},
            {.seconds = 3,
             .view = KmlView{.place = {-105, 38}, .altitude = 10, .mode = KmlAltitude::aboveGround, .range = 1000}},
            {.seconds = 3, .view = KmlView{.place = {-105, 38}, .tilt = 45}}}};
    if (!TERRAY_WITH_TRACKS) return;
    const auto back = parseKml(toKml(tour));
    ASSERT_TRUE(back.ok()) << back.failure().message;
    ASSERT_EQ(back->steps.size(), tour.steps.size());
    EXPECT_EQ(back->name, tour.name);
    for (size_t n = 0; n < tour.steps.size(); ++n) {
        const KmlStep &wanted = tour.steps[n], &found = back->steps[n];
        EXPECT_EQ(found.seconds, wanted.seconds) << n;
        EXPECT_EQ(found.smooth, wanted.smooth) << n;
        ASSERT_EQ(found.view.has_value(), wanted.view.has_value()) << n;
        if (!wanted.view) continue;
        EXPECT_EQ(found.view->place.longitude, wanted.view->place.longitude) << n;
        EXPECT_EQ(found.view->place.latitude, wanted.view->place.latitude) << n;
        EXPECT_EQ(found.view->altitude, wanted.view->altitude) << n;
        EXPECT_EQ(found.view->mode, wanted.view->mode) << n;
        EXPECT_EQ(found.view->heading, wanted.view->heading) << n;
        EXPECT_EQ(found.view->tilt, wanted.view->tilt) << n;
        EXPECT_EQ(found.view->range, wanted.view->range) << n;
        EXPECT_EQ(found.view->horizontalFov, wanted.view->horizontalFov) << n;
    }
}

#if TERRAY_WITH_TRACKS && TERRAY_WITH_PROJ

/// The analytic hills around 9 E, 47 N.
class KmlFlight : public testing::Test {
  protected:
    static Projection utm() { return Projection::create("EPSG:32632").value(); }

    AnalyticDataset dataset_{{.finestLevel = 1}};
    GroundHeights ground_{dataset_};
    Projection projection_ = utm();
    TemporaryDirectory directory_;
};

Flight wildFlight() {
    Random random(4);
    Flight flight{.dataset = "d", .name = "wild & free", .keys = {}};
    double seconds = 1.5;  // rests before its first key
    for (int n = 0; n < 200; ++n) {
        flight.keys.push_back({seconds, asWritten({.position = {random.between(3e5, 7e5), random.between(5e6, 5.4e6),
                                                                random.between(-50, 9000)},
                                                   .heading = Radians(random.between(0, 6.28)),
                                                   .pitch = Radians(random.between(-1.57, 1.57)),
                                                   .verticalFov = Radians(random.between(0.02, 3))})});
        seconds += random.between(0.001, 3);
    }
    return flight;
}

TEST_F(KmlFlight, AFlightComesBackToAMillimetreAndAMillionthOfADegree) {
    const Flight flight = wildFlight();
    exportFlight(flight, directory_ / "tour.kml", &projection_);
    const Flight back = importFlight(directory_ / "tour.kml", {}, &projection_, ground_);
    EXPECT_EQ(back.name, flight.name);
    EXPECT_NEAR(back.seconds(), flight.seconds(), 1e-9);
    const double angle = radiansFromDegrees(1e-6).value();
    // The tour holds two more keys of the first pose's rest, so keys are looked for by their times.
    for (const FlightKey& key : flight.keys) {
        const auto near = std::min_element(back.keys.begin(), back.keys.end(), [&](const auto& a, const auto& b) {
            return std::abs(a.seconds - key.seconds) < std::abs(b.seconds - key.seconds);
        });
        ASSERT_NEAR(near->seconds, key.seconds, 1e-9);
        EXPECT_LT(glm::distance(near->camera.position, key.camera.position), 1e-3);
        EXPECT_NEAR(std::remainder(near->camera.heading.value() - key.camera.heading.value(), 2 * M_PI), 0, 2 * angle)
            << "where north is, is known to 1e-6 degrees (Projection::gridHeadingOfNorth), and asked twice";
        EXPECT_NEAR(near->camera.pitch.value(), key.camera.pitch.value(), angle);
        EXPECT_NEAR(near->camera.verticalFov.value(), key.camera.verticalFov.value(), angle);
    }
}

TEST_F(KmlFlight, AJsonFlightThatIsImportedIsTheSame) {
    const Flight flight = wildFlight();
    exportFlight(flight, directory_ / "flight.json", &projection_);
    EXPECT_EQ(importFlight(directory_ / "flight.json", {}, &projection_, ground_), flight);
    EXPECT_EQ(importFlight(directory_ / "flight.json", {}, nullptr, ground_), flight) << "JSON needs no projection";
}

/// As Google's reference shows tours: Document, comments, updates and sounds between, both kinds of view.
constexpr const char* kForeign = R"(<?xml version="1.0" encoding="UTF-8"?>
<!-- written by hand -->
<kml xmlns="http://www.opengis.net/kml/2.2" xmlns:gx="http://www.google.com/kml/ext/2.2">
<Document><name>A document</name><open>1</open>
<gx:Tour><name>Play me</name><gx:Playlist>
  <gx:FlyTo><gx:duration>5.0</gx:duration>
    <Camera><longitude>9.01</longitude><latitude>47.0</latitude><altitude>9700</altitude>
      <heading>-6.333</heading><tilt>33.5</tilt><roll>0</roll><altitudeMode>absolute</altitudeMode></Camera>
  </gx:FlyTo>
  <gx:AnimatedUpdate><gx:duration>6.5</gx:duration></gx:AnimatedUpdate>
  <gx:Wait><gx:duration>2.5</gx:duration></gx:Wait>
  <gx:FlyTo><gx:duration>4.1</gx:duration><gx:flyToMode>smooth</gx:flyToMode>
    <LookAt><longitude>9.0</longitude><latitude>47.0</latitude><altitude>100</altitude>
      <heading>90</heading><tilt>60</tilt><range>2000</range>
      <gx:altitudeMode>absolute</gx:altitudeMode></LookAt>
  </gx:FlyTo>
  <gx:SoundCue><href>http://example.org/a.mp3</href></gx:SoundCue>
  <gx:FlyTo><gx:duration>3</gx:duration><gx:flyToMode>bounce</gx:flyToMode>
    <Camera><longitude>9.0</longitude><latitude>47.01</latitude><tilt>90</tilt><altitude>30</altitude>
      <altitudeMode>relativeToGround</altitudeMode></Camera>
  </gx:FlyTo>
  <gx:FlyTo><gx:duration>3</gx:duration>
    <Camera><longitude>9.0</longitude><latitude>47.02</latitude><tilt>90</tilt><altitude>30</altitude></Camera>
  </gx:FlyTo>
</gx:Playlist></gx:Tour></Document></kml>)";

TEST_F(KmlFlight, ATourOfAnotherProgramIsFlownAsItSays) {
    std::ofstream(directory_ / "foreign.kml") << kForeign;
    const Flight flight = importFlight(directory_ / "foreign.kml", {}, &projection_, ground_);
    EXPECT_EQ(flight.name, "Play me");
    EXPECT_NEAR(flight.seconds(), 2.5 + 4.1 + 3 + 3, 1e-9) << "the way to the first view takes no time";

    const Camera start = flight.at(0);
    const auto place = projection_.lonLat(glm::dvec2(start.position));
    EXPECT_NEAR(place->longitude, 9.01, 1e-8);
    EXPECT_EQ(start.position.z, 9700);
    EXPECT_NEAR(degreesFromRadians(start.pitch), 33.5 - 90, 1e-9);
    EXPECT_NEAR(degreesFromRadians(start.verticalFov), 45, 1e-9);
    for (double t = 0; t <= 2.5; t += 0.1)
        EXPECT_LT(glm::distance(flight.at(t).position, start.position), 1) << "it waits, " << t;

    // 2000 m away, looking east and 30 degrees down at the place.
    const Camera lookAt = flight.at(2.5 + 4.1);
    const glm::dvec2 target = projection_.plane({9, 47}).value();
    EXPECT_NEAR(lookAt.position.x, target.x - 2000 * std::sin(M_PI / 3), 0.1);
    EXPECT_NEAR(lookAt.position.y, target.y, 0.1);
    EXPECT_NEAR(lookAt.position.z, 100 + 2000 * std::cos(M_PI / 3), 1e-6);

    // Beyond the dataset's ground heights count from its lowest.
    const Camera above = flight.at(2.5 + 4.1 + 3);
    EXPECT_NEAR(above.position.z, dataset_.metadata().minHeight + 30, 1e-6);
    EXPECT_NEAR(flight.keys.back().camera.position.z, dataset_.metadata().minHeight, 1e-6) << "clamped";
    const auto after = std::find_if(flight.keys.begin(), flight.keys.end(),
                                    [&](const FlightKey& key) { return key.seconds > 2.5 + 4.1 + 3 + 1e-6; });
    EXPECT_EQ(after->camera, above) << "a bounce ends at rest";
}

TEST_F(KmlFlight, CutShortAnywhereItIsRefused) {
    const std::string whole = kForeign;
    for (size_t length = 0; length < whole.size(); length += 7)
        EXPECT_FALSE(parseKml(whole.substr(0, length)).ok()) << length;
}

TEST_F(KmlFlight, EachFaultIsNamed) {
    const std::string whole = kForeign;
    const auto why = [&](const std::string& from, const std::string& to) {
        std::string broken = whole;
        broken.replace(broken.find(from), from.size(), to);
        const auto tour = parseKml(broken);
        return tour.ok() ? std::string("nothing") : tour.failure().message;
    };
    EXPECT_NE(why("<longitude>9.01</longitude>", "").find("has no longitude"), std::string::npos);
    EXPECT_NE(why("<longitude>9.01<", "<longitude>190<").find("longitude is \"190\""), std::string::npos);
    EXPECT_NE(why(">5.0<", ">soon<").find("duration is \"soon\""), std::string::npos);
    EXPECT_NE(why(">absolute<", ">high<").find("expected absolute"), std::string::npos);
    EXPECT_NE(why("<tilt>60", "<tilt>nan").find("tilt is \"nan\""), std::string::npos);
    EXPECT_NE(parseKml("<gpx/>").failure().message.find("expected <kml>"), std::string::npos);
    EXPECT_NE(parseKml("<kml/>").failure().message.find("no tour"), std::string::npos);
    EXPECT_NE(parseKml("<kml><Tour/></kml>").failure().message.find("flies nowhere"), std::string::npos);
}

TEST_F(KmlFlight, FilesThatCannotBeReadOrWrittenHaveTheirCodes) {
    const auto codeOf = [](const auto& action) {
        try {
            action();
        } catch (const Error& error) {
            return error.code();
        }
        return ExitCode::ok;
    };
    const auto import = [&](const std::string& content, const Projection* projection) {
        std::ofstream(directory_ / "file", std::ios::trunc) << content;
        return codeOf([&] { (void)importFlight(directory_ / "file", {}, projection, ground_); });
    };
    EXPECT_EQ(import("", &projection_), ExitCode::input);
    EXPECT_EQ(import("PK\x03\x04", &projection_), ExitCode::input);
    EXPECT_EQ(import("<kml", &projection_), ExitCode::input);
    EXPECT_EQ(import(kForeign, nullptr), ExitCode::georeference);
    EXPECT_EQ(codeOf([&] { (void)importFlight(directory_ / "none", {}, &projection_, ground_); }), ExitCode::input);
    const Flight flight = wildFlight();
    EXPECT_EQ(codeOf([&] { exportFlight(flight, directory_ / "a.igc", &projection_); }), ExitCode::usage);
    EXPECT_EQ(codeOf([&] { exportFlight(flight, directory_ / "a.kml", nullptr); }), ExitCode::georeference);
    EXPECT_EQ(codeOf([&] { exportFlight(flight, directory_ / "no" / "a.kml", &projection_); }), ExitCode::output);
}

#endif

}  // namespace
}  // namespace terray::test
