// A recorded flight gives back, from its file and at the recorded times, the very poses that were drawn.

#include "client/stream/flight_recorder.h"

#include <gtest/gtest.h>

#include "tests/common/temporary_directory.h"
#include "tests/stream/fake_dataset.h"

namespace terray::test {
namespace {

Camera wildCamera(Random& random) {
    return {.position = {random.uniform(-1e6, 1e6), random.uniform(-1e6, 1e6), random.uniform(-100, 9000)},
            .heading = Radians(random.uniform(-20, 20)),
            .pitch = Radians(random.uniform(-1.5707963267948966, 1.5707963267948966)),
            .verticalFov = Radians(random.uniform(0.01, 3))};
}

TEST(FlightRecorder, APoseAsWrittenComesBackBitByBit) {
    Random random(1);
    for (int n = 0; n < 100'000; ++n) {
        const Camera camera = wildCamera(random);
        const Flight flight{.dataset = {}, .name = {}, .keys = {{0, asWritten(camera)}}};
        const auto back = flightFromJson(toJson(flight, nullptr));
        ASSERT_TRUE(back.ok()) << back.failure().message;
        ASSERT_EQ(*back, flight) << n;
        ASSERT_NEAR(flight.keys[0].camera.heading.value(), camera.heading.value(), 20e-15);
    }
}

TEST(FlightRecorder, LooksStraightUpAndDownAsWritten) {
    for (const double pitch : {-90.0, 90.0}) {
        const Camera camera{.pitch = radiansFromDegrees(pitch)};
        const Flight flight{.dataset = {}, .name = {}, .keys = {{0, asWritten(camera)}}};
        EXPECT_EQ(asWritten(camera), camera);
        EXPECT_TRUE(flightFromJson(toJson(flight, nullptr)).ok());
    }
}

TEST(FlightRecorder, ReplayOfASavedFlightGivesThePosesThatWereDrawn) {
    Random random(2);
    FlightRecorder recorder;
    std::vector<FlightKey> drawn;
    double clock = 7345.25;
    const double start = clock;
    for (int n = 0; n < 1000; ++n) {
        drawn.push_back({clock - start, recorder.record(clock, wildCamera(random))});
        clock += random.uniform(0.001, 0.1);
    }
    const TemporaryDirectory directory;
    saveFlight(recorder.flight("alps", "a recording"), directory / "flight.json", nullptr);
    const Flight replayed = loadFlight(directory / "flight.json");
    EXPECT_EQ(replayed.dataset, "alps");
    EXPECT_EQ(replayed.name, "a recording");
    ASSERT_EQ(replayed.keys.size(), drawn.size());
    EXPECT_EQ(replayed.keys.front().seconds, 0);
    for (const FlightKey& key : drawn) EXPECT_EQ(replayed.at(key.seconds), key.camera);
}

TEST(FlightRecorder, ARestIsFourKeysHoweverLongItIsAndTheCameraStaysThere) {
    Random random(3);
    FlightRecorder recorder;
    const Camera before = wildCamera(random), rest = asWritten(wildCamera(random)), after = wildCamera(random);
    recorder.record(0, before);
    for (int n = 1; n <= 1000; ++n) recorder.record(n, rest);
    recorder.record(1001, after);
    EXPECT_EQ(recorder.keys(), 6u);
    EXPECT_EQ(recorder.seconds(), 1001);
    const Flight flight = recorder.flight("", "");
    for (int n = 2; n <= 999; ++n) {
        const Camera camera = flight.at(n);
        EXPECT_NEAR(camera.position.x, rest.position.x, 1e-9) << n;
        EXPECT_NEAR(camera.heading.value(), rest.heading.value(), 1e-14) << n;
    }
    EXPECT_EQ(flight.at(1000), rest);
}

TEST(FlightRecorder, WhereTheClockStandsStillTheLaterPoseCounts) {
    FlightRecorder recorder;
    recorder.record(5, {.position = {1, 0, 0}});
    recorder.record(5, {.position = {2, 0, 0}});
    recorder.record(4, {.position = {3, 0, 0}});
    const Flight flight = recorder.flight("", "");
    ASSERT_EQ(flight.keys.size(), 1u);
    EXPECT_EQ(flight.keys[0].camera.position.x, 3);
}

}  // namespace
}  // namespace terray::test
