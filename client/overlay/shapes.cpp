#include "client/overlay/shapes.h"

#include <array>
#include <cmath>
#include <numbers>

#include "common/check.h"

namespace terray {
namespace {

/// Adds a quadrilateral, its corners counter-clockwise from outside.
void addQuad(OverlayMesh& mesh, const std::array<OverlayVertex, 4>& corners) {
    const auto first = static_cast<uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
    mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
}

/// A point of the line that turns about the vertical axis to make a pin, with its normal.
struct ProfilePoint {
    double radius, height;
    double outwards, upwards;
};

}  // namespace

OverlayMesh pinMesh(const glm::dvec3& tip, double height, const glm::vec3& colour) {
    TERRAY_CHECK_OP(height, >, 0);
    constexpr int kSlices = 36;
    constexpr int kBallSteps = 16;
    // The cone touches the ball, so the profile has no kink: sin(half of the tip's angle) = radius / distance.
    const double radius = height / 5;
    const double centre = height - radius;
    const double half = std::asin(radius / centre);
    std::vector<ProfilePoint> profile = {{0, 0, std::cos(half), -std::sin(half)}};
    for (int i = 0; i <= kBallSteps; ++i) {
        const double angle = -half + (std::numbers::pi / 2 + half) * i / kBallSteps;
        const double c = i == kBallSteps ? 0 : std::cos(angle);
        profile.push_back({radius * c, centre + radius * std::sin(angle), c, std::sin(angle)});
    }

    OverlayMesh mesh{.origin = tip, .colour = colour, .size = height};
    const auto vertex = [](const ProfilePoint& point, int slice) {
        const double angle = 2 * std::numbers::pi * (slice % kSlices) / kSlices;
        const glm::dvec3 out(std::cos(angle), std::sin(angle), 0);
        const glm::dvec3 up(0, 0, 1);
        return OverlayVertex{.anchor = glm::vec3(0),
                             .offset = glm::vec3(point.radius * out + point.height * up),
                             .normal = glm::vec3(point.outwards * out + point.upwards * up)};
    };
    for (size_t i = 0; i + 1 < profile.size(); ++i)
        for (int slice = 0; slice < kSlices; ++slice)
            addQuad(mesh, {vertex(profile[i], slice), vertex(profile[i], slice + 1), vertex(profile[i + 1], slice + 1),
                           vertex(profile[i + 1], slice)});
    return mesh;
}

OverlayMesh cubeMesh(const glm::dvec3& base, double side, const glm::vec3& colour) {
    TERRAY_CHECK_OP(side, >, 0);
    OverlayMesh mesh{.origin = base, .colour = colour, .size = side};
    const auto half = static_cast<float>(side / 2);
    for (int axis = 0; axis < 3; ++axis)
        for (const float sign : {-1.0f, 1.0f}) {
            glm::vec3 normal(0);
            normal[axis] = sign;
            // first x second = normal
            glm::vec3 first(0);
            glm::vec3 second(0);
            first[(axis + 1) % 3] = half;
            second[(axis + 2) % 3] = sign * half;
            const auto vertex = [&](float along, float across) {
                return OverlayVertex{.anchor = glm::vec3(0),
                                     .offset = half * normal + along * first + across * second + glm::vec3(0, 0, half),
                                     .normal = normal};
            };
            addQuad(mesh, {vertex(-1, -1), vertex(1, -1), vertex(1, 1), vertex(-1, 1)});
        }
    return mesh;
}

}  // namespace terray
