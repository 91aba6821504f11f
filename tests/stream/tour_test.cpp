// The standard tour works on any dataset and never dives under the ground.

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "client/stream/flight.h"
#include "client/stream/ground_map.h"
#include "tests/stream/fake_dataset.h"

namespace terray::test {
namespace {

/// Finest stored height under a place; lowest when there is none.
double finestHeight(const FakeDataset& dataset, glm::dvec2 place) {
    const Tiling& tiling = dataset.metadata.tiling;
    const double column = std::floor((place.x - tiling.west) / tiling.finestSpacing);
    const double row = std::floor((tiling.north - place.y) / tiling.finestSpacing);
    const auto& samples = dataset.metadata.samples;
    if (column < 0 || row < 0 || column >= static_cast<double>(samples.width) ||
        row >= static_cast<double>(samples.height))
        return -1e9;
    const auto x = static_cast<int64_t>(column), y = static_cast<int64_t>(row);
    const auto found = dataset.heights.find(
        {tiling.finestLevel, static_cast<uint32_t>(x / kTileCore), static_cast<uint32_t>(y / kTileCore)});
    if (found == dataset.heights.end()) return -1e9;
    const uint16_t code = found->second.codes.at(x % kTileCore + kHeightApron, y % kTileCore + kHeightApron);
    return code == kNoSurface ? -1e9 : found->second.encoding.height(code);
}

void expectClear(const FakeDataset& dataset, const Flight& tour) {
    const auto& size = dataset.metadata.samples;
    const double extent =
        static_cast<double>(std::max(size.width, size.height)) * dataset.metadata.tiling.finestSpacing;
    for (double t = 0; t <= tour.seconds(); t += 1.0 / 30) {
        const glm::dvec3 eye = tour.at(t).position;
        ASSERT_TRUE(std::isfinite(eye.x) && std::isfinite(eye.y) && std::isfinite(eye.z));
        ASSERT_GT(eye.z, finestHeight(dataset, glm::dvec2(eye)) + 0.003 * extent) << "at " << t << " s";
    }
}

struct Case {
    const char* name;
    GridSize samples;
    double spacing;
    HeightFormula height;
};

std::vector<Case> cases() {
    return {{"200 m of rubble, one tile", {200, 200}, 1, hills(8)},
            {"30 km of hills", {1000, 1300}, 30, hills(900)},
            {"5000 km, mostly flat", {1100, 1000}, 5000, hills(4000)},
            {"a strip", {1500, 60}, 10, hills(200)},
            {"a plane", {600, 600}, 2, [](int64_t, int64_t) { return -12.0; }},
            {"a cliff", {700, 700}, 1, [](int64_t x, int64_t y) { return x + 2 * y < 900 ? 0.0 : 400.0; }},
            {"holes",
             {900, 900},
             5,
             [](int64_t x, int64_t y) { return (x / 64 + y / 64) % 2 == 0 ? NAN : static_cast<double>(x % 50); }},
            {"one sample", {1, 1}, 10, [](int64_t, int64_t) { return 5.0; }}};
}

TEST(Tour, StaysClearOfTheGroundEverywhere) {
    for (const Case& item : cases()) {
        SCOPED_TRACE(item.name);
        const FakeDataset dataset = buildDataset(item.height, {.samples = item.samples, .spacing = item.spacing});
        for (const TourKindName& kind : kTourKinds) {
            SCOPED_TRACE(kind.name);
            const Flight tour = standardTour(FakeSource(dataset), 30, kind.kind);
            EXPECT_DOUBLE_EQ(tour.seconds(), 30);
            expectClear(dataset, tour);
        }
    }
}

TEST(Tour, IsTheSameEachTimeAndOfAnyLength) {
    const FakeDataset dataset = buildDataset(hills(100), {.samples = {512, 512}});
    const FakeSource source(dataset);
    EXPECT_EQ(standardTour(source, 20), standardTour(source, 20));
    for (const double seconds : {0.5, 3.0, 600.0}) {
        const Flight tour = standardTour(source, seconds);
        EXPECT_DOUBLE_EQ(tour.seconds(), seconds);
        expectClear(dataset, tour);
    }
}

TEST(Tour, HasAllItsPhases) {
    const FakeDataset dataset = buildDataset(hills(300), {.samples = {1024, 1024}, .spacing = 10});
    const GroundRect ground = dataset.metadata.groundBounds();
    const double extent = ground.east - ground.west;
    const Flight tour = standardTour(FakeSource(dataset), 60);
    bool outside = false, down = false, low = false, edge = false;
    bool headings[8] = {};
    for (double t = 0; t <= 60; t += 1.0 / 30) {
        const Camera camera = tour.at(t);
        const glm::dvec3 eye = camera.position;
        const bool within = eye.x > ground.west && eye.x < ground.east && eye.y > ground.south && eye.y < ground.north;
        const double above = eye.z - finestHeight(dataset, glm::dvec2(eye));
        outside = outside || (t < 6 && !within && eye.z > dataset.metadata.maxHeight);
        down = down || camera.pitch.value() < -1.57;
        const bool isLow = within && above < 0.1 * extent;
        low = low || (isLow && t < 25 && camera.pitch.value() > -0.3);
        const double toEdge =
            std::min({eye.x - ground.west, ground.east - eye.x, eye.y - ground.south, ground.north - eye.y});
        edge = edge || (isLow && toEdge < 0.01 * extent);
        if (t > 0.83 * 60 && std::abs(camera.pitch.value()) < 0.1)
            headings[static_cast<int>(std::floor(std::remainder(camera.heading.value(), 6.2831853) / 0.7854 + 4)) & 7] =
                true;
    }
    EXPECT_TRUE(outside);
    EXPECT_TRUE(down);
    EXPECT_TRUE(low);
    EXPECT_TRUE(edge);
    EXPECT_TRUE(std::all_of(std::begin(headings), std::end(headings), [](bool seen) { return seen; }));
}

/// What a flight over 10 km of hills does, at 30 looks a second.
struct Course {
    std::vector<Camera> cameras;
    std::vector<double> above;  ///< the finest ground, metres
    double extent = 0;
};

Course courseOf(TourKind kind) {
    static const FakeDataset dataset = buildDataset(hills(300), {.samples = {1024, 1024}, .spacing = 10});
    const GroundRect ground = dataset.metadata.groundBounds();
    const Flight tour = standardTour(FakeSource(dataset), 20, kind);
    Course course{.cameras = {}, .above = {}, .extent = ground.east - ground.west};
    for (int n = 0; n <= 600; ++n) {
        course.cameras.push_back(tour.at(n / 30.0));
        const glm::dvec3 eye = course.cameras.back().position;
        course.above.push_back(eye.z - finestHeight(dataset, glm::dvec2(eye)));
    }
    return course;
}

double highest(const Course& course) {
    return *std::max_element(course.above.begin(), course.above.end()) / course.extent;
}

/// Along the ground, from its first place to its last, in extents.
double way(const Course& course) {
    return glm::distance(glm::dvec2(course.cameras.front().position), glm::dvec2(course.cameras.back().position)) /
           course.extent;
}

TEST(Tour, TakesOffFromLowAndEndsHigh) {
    const Course course = courseOf(TourKind::takeOff);
    EXPECT_LT(course.above.front(), 0.08 * course.extent);
    EXPECT_GT(course.above.back(), 0.12 * course.extent);
    EXPECT_LT(glm::distance(course.cameras[0].position, course.cameras[60].position), 0.02 * course.extent) << "slow";
}

TEST(Tour, PassesAndDashesLow) {
    const Course pass = courseOf(TourKind::lowPass), dash = courseOf(TourKind::fastDash);
    EXPECT_LT(highest(pass), 0.1);
    EXPECT_LT(highest(dash), 0.1);
    EXPECT_GT(way(pass), 0.2);
    EXPECT_NEAR(way(dash), 0.9 * std::sqrt(2), 0.01) << "along a diagonal, a twentieth from its corners";
}

TEST(Tour, ClimbsAndNeverSinks) {
    const Course course = courseOf(TourKind::climb);
    for (size_t n = 1; n < course.cameras.size(); ++n)
        EXPECT_GE(course.cameras[n].position.z, course.cameras[n - 1].position.z - 1e-3 * course.extent) << n;
    EXPECT_LT(course.above.front(), 0.08 * course.extent);
    EXPECT_GT(course.cameras.back().position.z, 0.6 * course.extent);
}

TEST(Tour, LooksDownAllTheTimeAndTurns) {
    const Course course = courseOf(TourKind::lookDown);
    for (const Camera& camera : course.cameras) EXPECT_NEAR(camera.pitch.value(), -1.5707963, 1e-6);
    const Radians turn = course.cameras.back().heading - course.cameras.front().heading;
    EXPECT_NEAR(std::abs(std::remainder(turn.value(), 6.283185307)), 3.14159, 1e-3);
}

TEST(Tour, SweepsTheHorizonFromOnePlace) {
    const Course course = courseOf(TourKind::horizonSweep);
    std::vector<bool> seen(36, false);
    for (const Camera& camera : course.cameras) {
        EXPECT_LT(glm::distance(camera.position, course.cameras[0].position), 1e-3 * course.extent);
        seen[static_cast<size_t>(std::remainder(camera.heading.value(), 6.283185307) / 6.283185307 * 36 + 36) % 36] =
            true;
    }
    EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](bool one) { return one; }));
}

TEST(Tour, BeginsWithAllOfTheGroundAcrossThePicture) {
    for (const GridSize samples : {GridSize{1000, 1000}, {1200, 600}, {600, 1200}}) {
        const FakeDataset dataset = buildDataset(hills(300), {.samples = samples, .spacing = 10});
        const GroundRect ground = dataset.metadata.groundBounds();
        const View view = viewOf(standardTour(FakeSource(dataset), 30).at(0), 1280, 720);
        double left = 1, right = -1;  // in halves of the picture's width
        for (const double x : {ground.west, ground.east})
            for (const double y : {ground.south, ground.north}) {
                const glm::dvec3 way = glm::dvec3(x, y, dataset.metadata.minHeight) - view.eye;
                const double depth = glm::dot(way, view.forward);
                ASSERT_GT(depth, 0);
                const double across = glm::dot(way, view.right) / (depth * view.tanHalfWidth());
                EXPECT_LT(std::abs(glm::dot(way, view.up)) / (depth * view.tanHalfHeight), 1);
                left = std::min(left, across);
                right = std::max(right, across);
            }
        EXPECT_GT(left, -1);
        EXPECT_LT(right, 1);
        EXPECT_GT(right - left, 2 * 0.8) << samples.width << " x " << samples.height;
    }
}

/// Share of a picture's rays that meet the ground of a map, as a solid block of cells.
double groundShare(const GroundMap& map, const View& view) {
    const GroundRect& ground = map.bounds();
    const double farthest = 4 * std::max(ground.east - ground.west, ground.north - ground.south);
    int hits = 0;
    for (int row = 0; row < view.height; ++row) {
        for (int column = 0; column < view.width; ++column) {
            const glm::dvec3 way = view.direction(column + 0.5, row + 0.5);
            const double step = map.cellSide() / glm::length(glm::dvec2(way) + 1e-3);
            for (double t = 0; t < farthest; t += step) {
                const glm::dvec3 place = view.eye + t * way;
                if (place.z > map.highest() && way.z >= 0) break;
                const bool within =
                    place.x > ground.west && place.x < ground.east && place.y > ground.south && place.y < ground.north;
                if (!within || place.z > map.highestNear(glm::dvec2(place), 0)) continue;
                ++hits;
                break;
            }
        }
    }
    return hits / double(view.width * view.height);
}

TEST(Tour, HasGroundInViewAllTheTime) {
    for (const GridSize samples : {GridSize{700, 700}, {900, 500}}) {
        for (const double relief : {0.0, 300.0, 2000.0}) {
            const FakeDataset dataset = buildDataset(hills(relief), {.samples = samples, .spacing = 30});
            const FakeSource source(dataset);
            const GroundMap map = GroundMap::read(source);
            const Flight tour = standardTour(source, 30);
            for (double t = 0; t <= 30; t += 0.5)
                EXPECT_GE(groundShare(map, viewOf(tour.at(t), 16, 9)), 0.15)
                    << "at " << t << " s, relief " << relief << ", " << samples.width << " x " << samples.height;
        }
    }
}

TEST(Tour, ScalesWithTheExtent) {
    const FakeDataset small = buildDataset(hills(10), {.samples = {256, 256}, .spacing = 1, .west = 0, .north = 0});
    const FakeDataset large =
        buildDataset(hills(10000), {.samples = {256, 256}, .spacing = 1000, .west = 0, .north = 0, .quantum = 10});
    const Flight a = standardTour(FakeSource(small), 30), b = standardTour(FakeSource(large), 30);
    const auto length = [](const Flight& flight) {
        double sum = 0;
        for (double t = 0; t < 30; t += 0.1) sum += glm::distance(flight.at(t).position, flight.at(t + 0.1).position);
        return sum;
    };
    EXPECT_NEAR(length(b) / length(a), 1000, 50);
}

TEST(GroundMap, IsNeverBelowTheFinestGround) {
    const FakeDataset dataset = buildDataset(hills(300), {.samples = {2000, 1500}});
    const GroundMap map = GroundMap::read(FakeSource(dataset));
    Random random(7);
    const GroundRect ground = dataset.metadata.groundBounds();
    for (int i = 0; i < 20000; ++i) {
        const glm::dvec2 place(random.uniform(ground.west, ground.east), random.uniform(ground.south, ground.north));
        ASSERT_GE(map.highestNear(place, 0) + 1e-3, finestHeight(dataset, place));
    }
    EXPECT_EQ(map.highestNear({-1e12, 1e12}, 10), map.lowest());
    EXPECT_EQ(map.highestNear({ground.west, ground.north}, 1e9), map.highest());
}

}  // namespace
}  // namespace terray::test
