// Editing keeps a flight a flight: whatever was done to it, its file can be read again.

#include "client/stream/flight_editing.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/stream/fake_dataset.h"

namespace terray::test {
namespace {

Camera at(double x) {
    return {.position = {x, 0, 100}};
}

Flight fourKeys() {
    return {.dataset = "d", .name = "n", .keys = {{0, at(0)}, {1, at(10)}, {3, at(30)}, {4, at(40)}}};
}

std::vector<double> times(const Flight& flight) {
    std::vector<double> result;
    for (const FlightKey& key : flight.keys) result.push_back(key.seconds);
    return result;
}

TEST(FlightEditing, AddsAKeyBetweenItsNeighbours) {
    Flight flight = fourKeys();
    EXPECT_EQ(addKey(flight, 2, at(7)).value(), 2u);
    EXPECT_EQ(addKey(flight, 9, at(90)).value(), 5u);
    EXPECT_EQ(times(flight), (std::vector<double>{0, 1, 2, 3, 4, 9}));
    EXPECT_EQ(flight.at(2), at(7));
    Flight empty;
    EXPECT_EQ(addKey(empty, 0, at(1)).value(), 0u);
}

TEST(FlightEditing, RefusesAKeyWhereOneIsOrOutsideOfTime) {
    const Flight before = fourKeys();
    Flight flight = before;
    for (const double seconds : {1.0, 1.0004, 2.9996, -1.0, std::nan(""), 1e10}) {
        const auto added = addKey(flight, seconds, at(5));
        ASSERT_FALSE(added.ok()) << seconds;
        EXPECT_EQ(flight, before);
    }
    EXPECT_NE(addKey(flight, 1.0004, at(5)).failure().message.find("the key at 1 s is in the way"), std::string::npos);
    EXPECT_TRUE(addKey(flight, 1.001, at(5)).ok()) << "as near as keys may lie";
}

TEST(FlightEditing, DeletesAllButTheLastOne) {
    Flight flight = fourKeys();
    ASSERT_TRUE(deleteKey(flight, 1).ok());
    EXPECT_EQ(times(flight), (std::vector<double>{0, 3, 4}));
    ASSERT_TRUE(deleteKey(flight, 2).ok());
    ASSERT_TRUE(deleteKey(flight, 0).ok());
    EXPECT_FALSE(deleteKey(flight, 0).ok());
    EXPECT_EQ(times(flight), std::vector<double>{3});
}

TEST(FlightEditing, MovesAKeyInPlace) {
    Flight flight = fourKeys();
    moveKey(flight, 2, at(-5));
    EXPECT_EQ(flight.at(3), at(-5));
    EXPECT_EQ(times(flight), times(fourKeys()));
}

TEST(FlightEditing, RetimesAKeyOnlyBetweenItsNeighbours) {
    Flight flight = fourKeys();
    ASSERT_TRUE(retimeKey(flight, 1, 2.5).ok());
    EXPECT_EQ(times(flight), (std::vector<double>{0, 2.5, 3, 4}));
    EXPECT_FALSE(retimeKey(flight, 1, 3).ok());
    EXPECT_FALSE(retimeKey(flight, 1, 0).ok());
    EXPECT_TRUE(retimeKey(flight, 3, 400).ok());
    EXPECT_FALSE(retimeKey(flight, 0, -0.5).ok());
}

TEST(FlightEditing, GivesTheWayToAKeyMoreTimeAndMovesWhatFollows) {
    Flight flight = fourKeys();
    ASSERT_TRUE(retimeFrom(flight, 2, 5).ok());
    EXPECT_EQ(times(flight), (std::vector<double>{0, 1, 5, 6}));
    ASSERT_TRUE(retimeFrom(flight, 2, 1.5).ok());
    EXPECT_EQ(times(flight), (std::vector<double>{0, 1, 1.5, 2.5}));
    EXPECT_FALSE(retimeFrom(flight, 2, 1).ok());
    EXPECT_FALSE(retimeFrom(flight, 1, kMostFlightSeconds - 1).ok()) << "the last key would be beyond";
}

TEST(FlightEditing, StretchesAFlight) {
    Flight flight = fourKeys();
    ASSERT_TRUE(setDuration(flight, 8).ok());
    EXPECT_EQ(times(flight), (std::vector<double>{0, 2, 6, 8}));
    EXPECT_FALSE(setDuration(flight, 0.003).ok()) << "keys would lie closer than 1 ms";
    EXPECT_TRUE(setDuration(flight, 0.004).ok());
    Flight one{.dataset = {}, .name = {}, .keys = {{0, at(0)}}};
    EXPECT_FALSE(setDuration(one, 5).ok());
}

TEST(FlightEditing, AnyEditsLeaveAFlightThatItsFileGivesBack) {
    Random random(1);
    Flight flight = fourKeys();
    for (int n = 0; n < 3000; ++n) {
        const size_t key = random.next() % flight.keys.size();
        const double seconds = random.uniform(-1, 20);
        const Camera camera{.position = {random.uniform(-9, 9), 0, 0}, .heading = Radians(random.uniform(-7, 7))};
        switch (random.next() % 6) {
            case 0:
                (void)addKey(flight, seconds, camera);
                break;
            case 1:
                (void)deleteKey(flight, key);
                break;
            case 2:
                moveKey(flight, key, camera);
                break;
            case 3:
                (void)retimeKey(flight, key, seconds);
                break;
            case 4:
                (void)retimeFrom(flight, key, seconds);
                break;
            default:
                (void)setDuration(flight, seconds);
                break;
        }
        const auto back = flightFromJson(toJson(flight, nullptr));
        ASSERT_TRUE(back.ok()) << back.failure().message;
        ASSERT_EQ(*back, flight);
    }
}

/// A curve of many keys, with a rest at its end.
Flight recordedCircle() {
    Flight flight;
    for (int n = 0; n <= 600; ++n) {
        const double angle = 0.01 * std::min(n, 500);
        flight.keys.push_back(
            {n / 30.0,
             {.position = {1000 * std::sin(angle), 1000 * std::cos(angle), 500}, .heading = Radians(angle + 1.57)}});
    }
    return flight;
}

TEST(FlightEditing, ThinningKeepsTheCameraAsNearToEachKeyAsTold) {
    const Flight whole = recordedCircle();
    const Flight few = thinned(whole, Metres(2), Radians(0.01));
    EXPECT_LT(few.keys.size(), 40u);
    EXPECT_EQ(few.keys.front(), whole.keys.front());
    EXPECT_EQ(few.keys.back(), whole.keys.back());
    for (const FlightKey& key : whole.keys) {
        const Camera camera = few.at(key.seconds);
        EXPECT_LE(glm::distance(camera.position, key.camera.position), 2) << key.seconds;
        EXPECT_LE(std::abs(camera.heading.value() - key.camera.heading.value()), 0.01) << key.seconds;
    }
    EXPECT_GT(thinned(whole, Metres(0.01), Radians(0.0001)).keys.size(), few.keys.size());
}

TEST(FlightEditing, PreviewGoesThroughTheKeysAndAlongThePath) {
    const Flight flight = fourKeys();
    const auto points = pathPoints(flight, 4);
    ASSERT_EQ(points.size(), 3u * 5 + 1);
    for (size_t n = 0; n < 4; ++n) EXPECT_EQ(points[5 * n], flight.keys[n].camera.position);
    EXPECT_EQ(points[5 + 2], flight.at(1.8).position) << "two fifths of the way from 1 s to 3 s";
}

}  // namespace
}  // namespace terray::test
