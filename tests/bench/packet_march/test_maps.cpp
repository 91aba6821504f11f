#include "tests/bench/packet_march/test_maps.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include "preprocess/synthetic_terrain.h"
#include "tests/bench/packet_march/brute_force.h"
#include "tests/common/random.h"

namespace terray::test {
namespace {

TestMap mountains(GridSize size) {
    Grid<uint16_t> codes(size);
    const TerrainFunction terrain({.size = size.width, .spacing = 2, .seed = 5});
    std::vector<float> row(static_cast<size_t>(size.width));
    for (int64_t y = 0; y < size.height; ++y) {
        terrain.heights(2, 4 * y + 2, 4, row);
        for (int64_t x = 0; x < size.width; ++x)
            codes.at(x, y) = static_cast<uint16_t>(std::lround(row[static_cast<size_t>(x)]) + 1);
    }
    return {"mountains", std::move(codes)};
}

/// A map whose code at (x, y) is code(x, y).
template <class Code>
TestMap made(std::string name, GridSize size, Code code) {
    Grid<uint16_t> codes(size);
    for (int64_t y = 0; y < size.height; ++y)
        for (int64_t x = 0; x < size.width; ++x) codes.at(x, y) = static_cast<uint16_t>(code(x, y));
    return {std::move(name), std::move(codes)};
}

/// Whether a ray never is over a point with 0 < coordinate < last.
bool passesBy(float eye, float direction, float last) {
    if (eye <= 0) return direction <= 0;
    return eye >= last && direction >= 0;
}

}  // namespace

std::vector<TestMap> testMaps() {
    Random random(11);
    return {mountains({300, 217}),
            made("noise", {65, 34}, [&](int64_t, int64_t) { return 1 + random.below(40); }),
            made("terraces", {48, 129}, [](int64_t x, int64_t y) { return 10 + 25 * ((x / 5 + y / 7) % 3); }),
            made("plateau", {17, 17}, [](int64_t, int64_t) { return 100; }),
            made("shaft", {64, 64},
                 [](int64_t x, int64_t y) { return (x - 32) * (x - 32) + (y - 32) * (y - 32) < 40 ? 10 : 300; }),
            made("one patch", {2, 2}, [](int64_t x, int64_t y) { return x == y ? 5 : 25; })};
}

TestMap::TestMap(std::string mapName, Grid<uint16_t> mapCodes)
    : name(std::move(mapName)), codes(std::move(mapCodes)), steepest(0) {
    const auto samples = codes.view();
    extent = {static_cast<float>(samples.width() - 1), static_cast<float>(samples.height() - 1),
              static_cast<float>(std::ranges::max(codes.cells()))};
    for (int64_t y = 0; y < samples.height(); ++y)
        for (int64_t x = 0; x < samples.width(); ++x)
            for (const int other : {samples.clamped(x + 1, y), samples.clamped(x, y + 1)})
                steepest = std::max(steepest, static_cast<float>(std::abs(other - samples.at(x, y))));
}

float TestMap::rounding(const MapRay& ray) const {
    const glm::vec3 size = glm::abs(ray.eye) + extent;
    return 8 * 0x1p-24F * (size.z + 2 * steepest * std::max(size.x, size.y));
}

std::vector<MapRay> randomRays(const TestMap& map, size_t count, uint64_t seed) {
    Random random(seed);
    const glm::vec3 size = map.extent;
    const auto between = [&](double low, double high) { return static_cast<float>(random.between(low, high)); };
    std::vector<MapRay> rays(count);
    for (MapRay& ray : rays) {
        ray.eye = size * glm::vec3(between(-0.5, 1.5), between(-0.5, 1.5), between(-0.2, 3));
        // Towards a place on or near the map; some rays go the other way.
        const glm::vec3 aim = size * glm::vec3(between(-0.1, 1.1), between(-0.1, 1.1), between(-0.5, 1.2));
        ray.direction = (random.below(8) == 0 ? -1.0F : 1.0F) * glm::normalize(aim - ray.eye);
    }
    return rays;
}

std::vector<MapRay> specialRays(const TestMap& map) {
    const glm::vec3 size = map.extent;
    const float high = size.z + 3;
    std::vector<MapRay> rays;
    // Along the axes and diagonals, from sample centres (every corner is met exactly), from between them, from without.
    for (const glm::vec3 eye : {glm::vec3(1, 1, high),
                                {0, 0, high},
                                {size.x, size.y, high},
                                {0.5F, 0.5F, high},
                                {size.x / 2, 0, high},
                                {-2, 1, high},
                                {size.x + 3, size.y + 3, high}})
        for (const float x : {-1.0F, -0.25F, -0.0F, 0.0F, 1.0F})
            for (const float y : {-1.0F, -0.0F, 0.0F, 0.25F, 1.0F})
                for (const float z : {-4.0F, -0.5F, 0.0F, 0.5F}) rays.push_back({eye, {x, y, z}});
    // Level with the greatest code, within the ground, straight up out of it, of denormal and of no direction.
    for (const glm::vec3 direction : {glm::vec3(1, 1, 0), {1, 0, 0}, {0, 0, 1}, {1e-42F, -1e-42F, -1}, {0, 0, 0}}) {
        rays.push_back({{0, 0, size.z}, direction});
        rays.push_back({{0.5F, 0.5F, 1}, direction});
        rays.push_back({{0.25F, 0.75F, high}, direction});
    }
    return rays;
}

View viewOf(const TestMap& map, glm::dvec3 eye, double azimuth, double pitch) {
    const glm::dvec3 size(map.extent);
    View view;
    view.eye = glm::dvec3(eye.x * size.x, -eye.y * size.y, eye.z * size.z);
    view.forward = {std::sin(azimuth) * std::cos(pitch), std::cos(azimuth) * std::cos(pitch), std::sin(pitch)};
    view.right = {std::cos(azimuth), -std::sin(azimuth), 0};
    view.up = glm::cross(view.right, view.forward);
    // The last tiles reach beyond the picture, and a beam runs exactly along the view axis.
    view.width = 104;
    view.height = 56;
    return view;
}

void expectFirstContact(const TestMap& map, const MapRay& ray, double t) {
    if (passesBy(ray.eye.x, ray.direction.x, map.extent.x) || passesBy(ray.eye.y, ray.direction.y, map.extent.y))
        return;
    const double rounding = map.rounding(ray);
    const double earliest = bruteForceHit(map.codes.view(), ray, rounding);
    const double latest = bruteForceHit(map.codes.view(), ray, -rounding);
    const double slack = 1e-5;  // of t: its own rounding
    const auto where = [&] {
        std::ostringstream text;
        text << map.name << ", eye " << ray.eye.x << " " << ray.eye.y << " " << ray.eye.z << ", direction "
             << ray.direction.x << " " << ray.direction.y << " " << ray.direction.z;
        return text.str();
    };
    EXPECT_GE(t, std::isinf(earliest) ? earliest : earliest - slack * (1 + earliest)) << where();
    EXPECT_LE(t, latest + slack * (1 + latest)) << where();
}

}  // namespace terray::test
