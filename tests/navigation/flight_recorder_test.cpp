#include "client/navigation/flight_recorder.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/common/random.h"
#include "tests/common/temporary_directory.h"

namespace terray::test {
namespace {

Camera somewhere(Random& random) {
    return {.position = {random.between(4e5, 5e5), random.between(5e6, 6e6), random.between(0, 5000)},
            .heading = Radians(random.between(0, 6.28)),
            .pitch = Radians(random.between(-1.5, 1.5)),
            .verticalFov = Radians(random.between(0.2, 1.5))};
}

TEST(FlightRecorder, ReplaysEveryPoseExactlyAlsoFromItsFile) {
    Random random(1);
    FlightRecorder recorder;
    std::vector<FlightKey> poses;
    double seconds = 1234.5;
    for (int frame = 0; frame < 500; ++frame) {
        const bool rests = frame > 0 && random.below(3) == 0;
        poses.push_back({seconds - 1234.5, rests ? poses.back().camera : somewhere(random)});
        recorder.add(seconds, poses.back().camera);
        seconds += random.between(0.005, 0.1);
    }
    const TemporaryDirectory folder;
    saveFlight(recorder.flight("alps", "test"), folder / "flight.json", nullptr);
    const Flight flight = loadFlight(folder / "flight.json");
    EXPECT_EQ(flight.seconds(), poses.back().seconds);
    for (const FlightKey& key : flight.keys) {
        const auto pose =
            std::find_if(poses.begin(), poses.end(), [&](const FlightKey& p) { return p.seconds == key.seconds; });
        ASSERT_NE(pose, poses.end());
        EXPECT_EQ(flight.at(key.seconds).position, pose->camera.position) << "exactly, at a key";
    }
    for (const FlightKey& pose : poses) {
        const Camera replayed = flight.at(pose.seconds);
        // Of a long rest the frames between are the spline's, to the last places.
        EXPECT_LT(glm::distance(replayed.position, pose.camera.position), 1e-8) << pose.seconds;
        // Angles pass through degrees in the file.
        EXPECT_NEAR(std::remainder(replayed.heading.value() - pose.camera.heading.value(), 6.283185307179586), 0,
                    1e-12);
        EXPECT_NEAR(replayed.pitch.value(), pose.camera.pitch.value(), 1e-12);
        EXPECT_NEAR(replayed.verticalFov.value(), pose.camera.verticalFov.value(), 1e-12);
    }
}

TEST(FlightRecorder, RestsWhereTheCameraRested) {
    Random random(2);
    const Camera a = somewhere(random), b = somewhere(random);
    FlightRecorder recorder;
    for (int frame = 0; frame <= 100; ++frame) recorder.add(frame * 0.1, frame <= 50 ? a : b);
    const Flight flight = recorder.flight("", "");
    EXPECT_EQ(flight.keys.size(), 8u) << "four of each rest";
    EXPECT_LT(glm::distance(flight.at(2.5).position, a.position), 1e-8);
    EXPECT_LT(glm::distance(flight.at(7.5).position, b.position), 1e-8);
}

TEST(FlightRecorder, FramesOfNoTimeCountOnce) {
    Random random(3);
    FlightRecorder recorder;
    for (int frame = 0; frame < 10; ++frame) recorder.add(5, somewhere(random));
    EXPECT_EQ(recorder.flight("", "").keys.size(), 1u);
}

}  // namespace
}  // namespace terray::test
