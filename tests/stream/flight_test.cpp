#include "client/stream/flight.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "common/error.h"
#include "tests/stream/fake_dataset.h"

namespace terray::test {
namespace {

Flight randomFlight(uint64_t seed) {
    Random random(seed);
    Flight flight{.dataset = "alps", .name = "test \"quoted\"", .keys = {}};
    double seconds = random.uniform(0, 2);
    for (int i = 0; i < 12; ++i) {
        flight.keys.push_back(
            {seconds,
             {.position = {random.uniform(-1e6, 1e6), random.uniform(-1e6, 1e6), random.uniform(0, 5000)},
              .heading = Radians(random.uniform(0, 6.28)),
              .pitch = Radians(random.uniform(-1.2, 1.2)),
              .verticalFov = radiansFromDegrees(random.uniform(20, 90))}});
        seconds += random.uniform(0.1, 5);
    }
    return flight;
}

double turn(Radians from, Radians to) {
    return std::remainder(to.value() - from.value(), 6.283185307179586);
}

TEST(Flight, IsExactAtItsKeysAndRestsOutside) {
    const Flight flight = randomFlight(1);
    for (const FlightKey& key : flight.keys) EXPECT_EQ(flight.at(key.seconds), key.camera);
    EXPECT_EQ(flight.at(-5), flight.keys.front().camera);
    EXPECT_EQ(flight.at(1e9), flight.keys.back().camera);
    EXPECT_EQ(flight.seconds(), flight.keys.back().seconds);
}

TEST(Flight, HasNoJumpInPlaceOrVelocity) {
    constexpr double kStep = 1e-4;
    for (uint64_t seed = 1; seed < 6; ++seed) {
        const Flight flight = randomFlight(seed);
        for (const FlightKey& key : flight.keys) {
            const Camera before = flight.at(key.seconds - kStep), at = flight.at(key.seconds),
                         after = flight.at(key.seconds + kStep);
            const glm::dvec3 arriving = (at.position - before.position) / kStep,
                             leaving = (after.position - at.position) / kStep;
            // Of accelerations up to some 1e7 m/s^2 in this wild flight, a step shows a thousandth of the speed.
            EXPECT_LT(glm::distance(arriving, leaving), 1e-3 * (1e6 + glm::length(leaving)));
            EXPECT_NEAR(turn(before.heading, at.heading) / kStep, turn(at.heading, after.heading) / kStep, 0.1);
            EXPECT_NEAR((at.pitch - before.pitch).value() / kStep, (after.pitch - at.pitch).value() / kStep, 0.1);
        }
    }
}

TEST(Flight, FollowsAParabolaExactlyBetweenInnerKeys) {
    Flight flight;
    const auto place = [](double t) { return glm::dvec3(3 * t - t * t, 2 + t, 0.5 * t * t); };
    for (const double t : {0.0, 1.0, 2.5, 3.0, 5.0, 6.0}) flight.keys.push_back({t, {.position = place(t)}});
    for (double t = 1; t <= 5; t += 0.1) EXPECT_LT(glm::distance(flight.at(t).position, place(t)), 1e-9) << t;
}

TEST(Flight, TurnsTheShorterWayRound) {
    const Flight flight{.dataset = {},
                        .name = {},
                        .keys = {{0, {.heading = radiansFromDegrees(350)}}, {1, {.heading = radiansFromDegrees(10)}}}};
    for (double t = 0; t <= 1; t += 0.05)
        EXPECT_LE(std::abs(turn(Radians(0), flight.at(t).heading)), radiansFromDegrees(10.0001).value());
}

TEST(Flight, OfOneKeyRests) {
    const Flight flight{.dataset = {}, .name = {}, .keys = {{3, {.position = {1, 2, 3}}}}};
    for (const double t : {0.0, 3.0, 9.0}) EXPECT_EQ(flight.at(t).position, glm::dvec3(1, 2, 3));
}

void expectSame(const Flight& a, const Flight& b) {
    EXPECT_EQ(a.dataset, b.dataset);
    EXPECT_EQ(a.name, b.name);
    ASSERT_EQ(a.keys.size(), b.keys.size());
    for (size_t i = 0; i < a.keys.size(); ++i) {
        EXPECT_EQ(a.keys[i].seconds, b.keys[i].seconds);
        EXPECT_EQ(a.keys[i].camera.position, b.keys[i].camera.position);
        // Degrees in the file: two roundings.
        EXPECT_NEAR(a.keys[i].camera.heading.value(), b.keys[i].camera.heading.value(), 1e-14);
        EXPECT_NEAR(a.keys[i].camera.pitch.value(), b.keys[i].camera.pitch.value(), 1e-15);
        EXPECT_NEAR(a.keys[i].camera.verticalFov.value(), b.keys[i].camera.verticalFov.value(), 1e-15);
    }
}

TEST(Flight, ComesBackFromJson) {
    const Flight flight = randomFlight(2);
    const auto json = Json::parse(toJson(flight, nullptr).dump());
    ASSERT_TRUE(json.ok());
    const auto back = flightFromJson(*json);
    ASSERT_TRUE(back.ok()) << back.failure().message;
    expectSame(flight, *back);
}

#if TERRAY_WITH_PROJ
TEST(Flight, TellsPeopleLongitudeAndLatitude) {
    const auto utm = Projection::create("EPSG:32632");  // central meridian 9 E
    ASSERT_TRUE(utm.ok());
    const Flight flight{.dataset = {}, .name = {}, .keys = {{0, {.position = {500000, 5200000, 10}}}}};
    const Json json = toJson(flight, &*utm);
    const Json& key = json.find("keys")->array()[0];
    EXPECT_NEAR(*key.numberAt("longitude"), 9, 1e-9);
    EXPECT_NEAR(*key.numberAt("latitude"), 46.95, 0.01);
    EXPECT_NEAR(*key.numberAt("true_heading_deg"), 0, 1e-6);
    expectSame(flight, *flightFromJson(json));
}
#endif

TEST(Flight, RefusesJsonThatIsNoFlight) {
    const std::string key = R"({"seconds":0,"x_m":0,"y_m":0,"height_m":0,"heading_deg":0,"pitch_deg":0,"fov_deg":45})";
    const auto why = [](const std::string& text) {
        const auto json = Json::parse(text);
        if (!json) return json.failure().message;
        const auto flight = flightFromJson(*json);
        return flight.ok() ? std::string() : flight.failure().message;
    };
    const std::string head = R"({"format":"terray-flight","version":1,"dataset":"d","name":"n","keys":)";
    EXPECT_EQ(why(head + "[" + key + "]}"), "");
    EXPECT_NE(why("[]"), "");
    EXPECT_NE(why("{}").find("terray-flight"), std::string::npos);
    EXPECT_NE(why(R"({"format":"terray-flight","version":2,"dataset":"d","name":"n","keys":[]})").find("version 2"),
              std::string::npos);
    EXPECT_NE(why(head + "[]}").find("without keys"), std::string::npos);
    EXPECT_NE(why(head + "{}}").find("without keys"), std::string::npos);
    EXPECT_NE(why(head + "[" + key + "," + key + "]}").find("key 1: \"seconds\" must be greater"), std::string::npos);
    EXPECT_NE(why(head + "[{\"seconds\":0}]}").find("key 0: "), std::string::npos);
    std::string steep = key;
    steep.replace(steep.find("\"pitch_deg\":0"), 13, "\"pitch_deg\":95");
    EXPECT_NE(why(head + "[" + steep + "]}").find("\"pitch_deg\" is 95"), std::string::npos);
}

TEST(Flight, ComesBackFromAFileAndRefusesOtherFiles) {
    const auto directory = std::filesystem::temp_directory_path() / "terray_flight_test";
    std::filesystem::remove_all(directory);
    std::filesystem::create_directories(directory);
    const auto path = directory / "flight.json";
    const Flight flight = randomFlight(3);
    saveFlight(flight, path, nullptr);
    expectSame(flight, loadFlight(path));

    const auto codeOf = [](const auto& action) {
        try {
            action();
        } catch (const Error& error) {
            return error.code();
        }
        return ExitCode::ok;
    };
    EXPECT_EQ(codeOf([&] { (void)loadFlight(directory / "none.json"); }), ExitCode::input);
    EXPECT_EQ(codeOf([&] { (void)loadFlight(directory); }), ExitCode::input);
    std::ofstream(directory / "broken.json") << "{\"format\":";
    EXPECT_EQ(codeOf([&] { (void)loadFlight(directory / "broken.json"); }), ExitCode::input);
    EXPECT_EQ(codeOf([&] { saveFlight(flight, directory / "no" / "where.json", nullptr); }), ExitCode::output);
    std::filesystem::remove_all(directory);
}

}  // namespace
}  // namespace terray::test
