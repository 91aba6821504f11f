// Meshes of tubes, pins and cubes: closed, facing outwards, of the right size.

#include "client/overlay/shapes.h"

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/common/random.h"

namespace terray {
namespace {

using Line = std::vector<glm::dvec3>;

glm::dvec3 placeOf(const OverlayMesh& mesh, uint32_t index) {
    const OverlayVertex& vertex = mesh.vertices.at(index);
    return mesh.origin + glm::dvec3(vertex.anchor) + glm::dvec3(vertex.offset);
}

using Triangle = std::array<glm::dvec3, 3>;

std::vector<Triangle> trianglesOf(const OverlayMesh& mesh) {
    std::vector<Triangle> result;
    for (size_t i = 0; i < mesh.indices.size(); i += 3)
        result.push_back(
            {placeOf(mesh, mesh.indices[i]), placeOf(mesh, mesh.indices[i + 1]), placeOf(mesh, mesh.indices[i + 2])});
    return result;
}

glm::dvec3 faceNormal(const Triangle& triangle) {
    return glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
}

/// Every edge is run along as often one way as the other, by places (corners that share one may have own normals).
void expectClosed(const OverlayMesh& mesh) {
    ASSERT_EQ(mesh.indices.size() % 3, 0u);
    using Place = std::tuple<double, double, double>;
    std::map<std::pair<Place, Place>, int> edges;
    for (const Triangle& triangle : trianglesOf(mesh))
        for (size_t i = 0; i < 3; ++i) {
            // To the millimetre: cosines of one angle and of the same a turn further differ in the last place.
            const auto place = [](const glm::dvec3& p) {
                return Place(std::round(p.x * 1e3), std::round(p.y * 1e3), std::round(p.z * 1e3));
            };
            const Place from = place(triangle[i]);
            const Place to = place(triangle[(i + 1) % 3]);
            ++edges[{from, to}];
            --edges[{to, from}];
        }
    for (const auto& [edge, balance] : edges) ASSERT_EQ(balance, 0);
}

double volumeOf(const OverlayMesh& mesh) {
    double volume = 0;
    for (const Triangle& t : trianglesOf(mesh)) {
        const glm::dvec3 from = mesh.origin;
        volume += glm::dot(t[0] - from, glm::cross(t[1] - from, t[2] - from)) / 6;
    }
    return volume;
}

void expectUnitNormals(const OverlayMesh& mesh) {
    for (const OverlayVertex& vertex : mesh.vertices) EXPECT_NEAR(glm::length(vertex.normal), 1, 1e-6);
}

/// For convex things: each face and each corner's normal point away from a place inside.
void expectOutwards(const OverlayMesh& mesh) {
    const std::vector<Triangle> triangles = trianglesOf(mesh);
    for (size_t i = 0; i < triangles.size(); ++i) {
        const glm::dvec3 normal = faceNormal(triangles[i]);
        if (glm::length(normal) < 1e-9) continue;  // at a pole two corners are one
        for (size_t corner = 0; corner < 3; ++corner) {
            const glm::dvec3 stated(mesh.vertices[mesh.indices[3 * i + corner]].normal);
            // A pin's faces span 10 by 6.5 degrees: half the diagonal is cos(6 degrees) = 0.9945, at the pole a little
            // more.
            EXPECT_GT(glm::dot(glm::normalize(normal), stated), 0.992) << i;
        }
    }
}

/// Nearest distance from a point to lines.
double distanceTo(const std::vector<Line>& lines, const glm::dvec3& point) {
    double nearest = 1e300;
    for (const Line& line : lines)
        for (size_t i = 0; i < line.size(); ++i) {
            const glm::dvec3 along = line[std::min(i + 1, line.size() - 1)] - line[i];
            const double length = glm::dot(along, along);
            const double share = length > 0 ? glm::clamp(glm::dot(point - line[i], along) / length, 0.0, 1.0) : 0;
            nearest = std::min(nearest, glm::distance(point, line[i] + share * along));
        }
    return nearest;
}

/// Distance along a ray to the first triangle that faces its eye, as it is drawn. Source: Moeller, Trumbore 1997.
std::optional<double> cast(const std::vector<Triangle>& triangles, const glm::dvec3& eye, const glm::dvec3& ray) {
    double nearest = 1e300;
    for (const Triangle& t : triangles) {
        const glm::dvec3 a = t[1] - t[0];
        const glm::dvec3 b = t[2] - t[0];
        const glm::dvec3 p = glm::cross(ray, b);
        const double determinant = glm::dot(a, p);
        if (determinant < 1e-12) continue;
        const glm::dvec3 s = eye - t[0];
        const double u = glm::dot(s, p) / determinant;
        const glm::dvec3 q = glm::cross(s, a);
        const double v = glm::dot(ray, q) / determinant;
        const double distance = glm::dot(b, q) / determinant;
        if (u < 0 || v < 0 || u + v > 1 || distance <= 0 || distance >= nearest) continue;
        nearest = distance;
    }
    if (nearest == 1e300) return {};
    return nearest;
}

/// What is seen of a tube from all around is at about its radius from the lines, and no ray gets inside unseen.
void expectTube(const std::vector<Line>& lines, const TubeStyle& style, uint64_t seed) {
    const OverlayMesh mesh = tubeMesh(lines, style);
    expectClosed(mesh);
    expectUnitNormals(mesh);
    const std::vector<Triangle> triangles = trianglesOf(mesh);
    // Cross-sections of straight parts, times half a step at corners and ends; mitres thin by 0.1 %.
    const double inner = std::cos(std::numbers::pi / style.sides) * std::cos(std::numbers::pi / 12) * 0.999;
    test::Random random(seed);
    int hits = 0;
    for (int i = 0; i < 800; ++i) {
        const Line& line = lines[random.below(lines.size())];
        const auto offset = [&](double size) {
            return glm::dvec3(random.between(-size, size), random.between(-size, size), random.between(-size, size));
        };
        // From far away to near a corner or a point between two.
        const size_t corner = random.below(line.size());
        const glm::dvec3 aim = glm::mix(line[corner], line[std::min(corner + 1, line.size() - 1)],
                                        random.below(2) == 0 ? 0.0 : random.between(0, 1)) +
                               offset(1.2 * style.radius);
        const glm::dvec3 eye = aim + 1000.0 * glm::normalize(offset(1) + glm::dvec3(1e-3));
        const glm::dvec3 ray = glm::normalize(aim - eye);
        const auto hit = cast(triangles, eye, ray);
        for (double t = 1000 - 200; t < std::min(hit.value_or(1e300), 1200.0); t += style.radius / 50)
            ASSERT_GT(distanceTo(lines, eye + t * ray), inner * style.radius) << "a ray is inside the tube unseen";
        if (!hit) continue;
        ++hits;
        const double away = distanceTo(lines, eye + *hit * ray);
        EXPECT_LT(away, style.radius * (1 + 1e-4));
        EXPECT_GT(away, style.radius * inner);
    }
    EXPECT_GT(hits, 200);
}

TEST(Tube, AlongAStraightLineIsACylinderWithRoundEnds) {
    const std::vector<Line> lines = {{{100, 200, 50}, {160, 200, 50}}};
    for (const int sides : {3, 8, 32}) expectTube(lines, {.radius = 4, .sides = sides}, 1);
    // Fine enough, its volume is that of cylinder and ball.
    const double exact = std::numbers::pi * 16 * 60 + 4.0 / 3 * std::numbers::pi * 64;
    EXPECT_NEAR(volumeOf(tubeMesh(lines, {.radius = 4, .sides = 96})), exact, 0.02 * exact);
}

TEST(Tube, RunsInAnyDirection) {
    for (const glm::dvec3 end :
         {glm::dvec3(0, 0, 40), glm::dvec3(0, 0, -40), glm::dvec3(0, 40, 0), glm::dvec3(-30, 5, 9)})
        expectTube({{{0, 0, 0}, end}}, {.radius = 3}, 2);
}

TEST(Tube, DoesNotPinchAtCornersOfAnyAngle) {
    for (const double degrees : {1.0, 4.9, 5.1, 30.0, 90.0, 135.0, 170.0, 179.9, 180.0}) {
        SCOPED_TRACE(degrees);
        const double turn = degrees * std::numbers::pi / 180;
        expectTube({{{0, 0, 0}, {30, 0, 0}, {30 + 30 * std::cos(turn), 30 * std::sin(turn), 0}}}, {.radius = 3}, 3);
    }
}

TEST(Tube, GoesExactlyStraightOnAndExactlyBack) {
    expectTube({{{0, 0, 0}, {30, 0, 0}, {60, 0, 0}}}, {.radius = 3}, 9);
    expectTube({{{0, 0, 0}, {30, 0, 0}, {0, 0, 0}}}, {.radius = 3}, 10);
    expectTube({{{0, 0, 0}, {0, 0, 30}, {0, 0, 5}}}, {.radius = 3}, 11);
}

TEST(Tube, KeepsItsShapeAlongAHelixAndAmongShortSteps) {
    Line helix;
    for (int i = 0; i < 40; ++i) helix.emplace_back(20 * std::cos(0.3 * i), 20 * std::sin(0.3 * i), 2 * i);
    expectTube({helix}, {.radius = 2}, 4);
    // Steps shorter than the radius, to and fro.
    test::Random random(5);
    Line walk = {{0, 0, 0}};
    for (int i = 0; i < 30; ++i)
        walk.push_back(walk.back() + glm::dvec3(random.between(-1, 2), random.between(-2, 2), random.between(-2, 2)));
    expectTube({walk}, {.radius = 3}, 6);
}

TEST(Tube, LeavesOutPointsThatRepeatAndMakesABallOfOnePoint) {
    const TubeStyle style{.radius = 4};
    const Line plain = {{0, 0, 0}, {20, 0, 0}, {20, 20, 0}};
    const Line stuttering = {{0, 0, 0}, {0, 0, 0}, {20, 0, 0}, {20, 0.1, 0}, {20, 0, 0}, {20, 20, 0}, {20, 20, 0}};
    EXPECT_EQ(tubeMesh(std::vector<Line>{plain}, style).vertices.size(),
              tubeMesh(std::vector<Line>{stuttering}, style).vertices.size());
    expectTube({{{7, 8, 9}}}, style, 7);
    expectTube({{{7, 8, 9}, {7, 8, 9}}}, style, 7);
    EXPECT_TRUE(tubeMesh({}, style).indices.empty());
    EXPECT_TRUE(tubeMesh(std::vector<Line>{Line{}}, style).indices.empty());
}

TEST(Tube, HasAllItsLinesAndNothingBetweenThem) {
    expectTube({{{0, 0, 0}, {20, 0, 0}}, {{0, 40, 0}, {20, 40, 5}}, {{50, 0, 0}}}, {.radius = 2}, 8);
}

TEST(Tube, IsAsExactFarFromTheWorldsOriginAsNearIt) {
    // Half a million metres from 0, as in UTM: offsets are from the mesh's own origin.
    const glm::dvec3 far(512345.25, 5212345.75, 1234.5);
    const OverlayMesh mesh = tubeMesh(std::vector<Line>{{far, far + glm::dvec3(10, 0, 0)}}, {.radius = 1});
    for (const OverlayVertex& vertex : mesh.vertices) {
        EXPECT_NEAR(glm::length(glm::dvec3(vertex.offset)), 1, 1e-6);
        const glm::dvec3 anchor = mesh.origin + glm::dvec3(vertex.anchor);
        EXPECT_LT(std::min(glm::distance(anchor, far), glm::distance(anchor, far + glm::dvec3(10, 0, 0))), 1e-6);
    }
}

TEST(Pin, StandsWithItsTipOnThePlaceAndIsAsTallAsAsked) {
    const glm::dvec3 tip(1000, 2000, 300);
    const OverlayMesh pin = pinMesh(tip, 50, glm::vec3(1, 0, 0));
    expectClosed(pin);
    expectUnitNormals(pin);
    expectOutwards(pin);
    double lowest = 1e9;
    double highest = -1e9;
    double widest = 0;
    for (uint32_t i = 0; i < pin.vertices.size(); ++i) {
        const glm::dvec3 place = placeOf(pin, i);
        lowest = std::min(lowest, place.z);
        highest = std::max(highest, place.z);
        widest = std::max(widest, std::hypot(place.x - tip.x, place.y - tip.y));
        EXPECT_EQ(pin.vertices[i].anchor, glm::vec3(0)) << "it grows from its tip";
    }
    EXPECT_DOUBLE_EQ(lowest, 300);
    EXPECT_NEAR(highest, 350, 1e-4);
    EXPECT_NEAR(widest, 10, 0.1);
    EXPECT_GT(volumeOf(pin), 0);
}

TEST(Cube, StandsOnItsBase) {
    const OverlayMesh cube = cubeMesh({10, 20, 30}, 8, glm::vec3(1));
    expectClosed(cube);
    expectUnitNormals(cube);
    expectOutwards(cube);
    EXPECT_NEAR(volumeOf(cube), 512, 1e-3);
    for (uint32_t i = 0; i < cube.vertices.size(); ++i) {
        const glm::dvec3 place = placeOf(cube, i);
        EXPECT_NEAR(std::abs(place.x - 10), 4, 1e-6);
        EXPECT_NEAR(std::abs(place.y - 20), 4, 1e-6);
        EXPECT_TRUE(place.z == 30 || place.z == 38);
    }
}

}  // namespace
}  // namespace terray
