#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "client/overlay/shapes.h"
#include "common/check.h"

namespace terray {
namespace {

constexpr double kMitred = 5 * std::numbers::pi / 180;     ///< largest corner that one cross-section does for
constexpr double kBendStep = 30 * std::numbers::pi / 180;  ///< largest turn from one cross-section to the next
constexpr int kCapRings = 2;                               ///< between the tube's end and the end ball's pole
constexpr double kCapStep = std::numbers::pi / 2 / (kCapRings + 1);

/// `vector` turned about a unit axis (Rodrigues' formula).
glm::dvec3 turned(const glm::dvec3& vector, const glm::dvec3& axis, double angle) {
    const double c = std::cos(angle);
    return c * vector + std::sin(angle) * glm::cross(axis, vector) + (1 - c) * glm::dot(axis, vector) * axis;
}

/// A cross-section's frame: the way ahead, and a side at right angles to it that the next frames carry on without
/// twist.
struct Frame {
    glm::dvec3 ahead;
    glm::dvec3 side;
};

Frame frameAlong(const glm::dvec3& ahead) {
    const glm::dvec3 axis = std::abs(ahead.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
    return {ahead, glm::normalize(glm::cross(axis, ahead))};
}

Frame turned(const Frame& frame, const glm::dvec3& axis, double angle) {
    return {turned(frame.ahead, axis, angle), turned(frame.side, axis, angle)};
}

class TubeBuilder {
  public:
    TubeBuilder(const TubeStyle& style, OverlayMesh& mesh) : style_(style), mesh_(mesh) {}

    /// @param points  from the mesh's origin, no two neighbours in one place, at least one
    void add(const std::vector<glm::dvec3>& points) {
        const auto direction = [&](size_t from) { return glm::normalize(points[from + 1] - points[from]); };
        Frame frame = frameAlong(points.size() > 1 ? direction(0) : glm::dvec3(0, 0, 1));
        beginAt(points.front(), frame);
        for (size_t i = 1; i + 1 < points.size(); ++i) frame = corner(points[i], frame, direction(i));
        if (points.size() > 1) ring(points.back(), frame, 0);
        endAt(points.back(), frame);
    }

  private:
    /// A ring of vertices about a point. @param tilt  angle ahead of the cross-section, 0 but on end balls
    void ring(const glm::dvec3& centre, const Frame& frame, double tilt) {
        const auto start = static_cast<uint32_t>(mesh_.vertices.size());
        const auto sides = static_cast<uint32_t>(style_.sides);
        const glm::dvec3 across = glm::cross(frame.ahead, frame.side);
        for (uint32_t k = 0; k < sides; ++k) {
            const double angle = 2 * std::numbers::pi * k / sides;
            vertex(centre, std::cos(tilt) * (std::cos(angle) * frame.side + std::sin(angle) * across) +
                               std::sin(tilt) * frame.ahead);
        }
        for (uint32_t k = 0; joined_ && k < sides; ++k) {
            const uint32_t next = (k + 1) % sides;
            triangle(start - sides + k, start - sides + next, start + next);
            triangle(start - sides + k, start + next, start + k);
        }
        joined_ = true;
    }

    /// Half a ball, and the tube's first ring.
    void beginAt(const glm::dvec3& centre, const Frame& frame) {
        vertex(centre, -frame.ahead);
        const auto sides = static_cast<uint32_t>(style_.sides);
        const auto first = static_cast<uint32_t>(mesh_.vertices.size());
        for (uint32_t k = 0; k < sides; ++k) triangle(first - 1, first + (k + 1) % sides, first + k);
        joined_ = false;
        for (int i = kCapRings; i >= 0; --i) ring(centre, frame, -i * kCapStep);
    }

    /// Half a ball behind the tube's last ring.
    void endAt(const glm::dvec3& centre, const Frame& frame) {
        for (int i = 1; i <= kCapRings; ++i) ring(centre, frame, i * kCapStep);
        const auto sides = static_cast<uint32_t>(style_.sides);
        const auto pole = static_cast<uint32_t>(mesh_.vertices.size());
        for (uint32_t k = 0; k < sides; ++k) triangle(pole, pole - sides + k, pole - sides + (k + 1) % sides);
        vertex(centre, frame.ahead);
    }

    /// @return the frame behind the corner
    Frame corner(const glm::dvec3& centre, const Frame& before, const glm::dvec3& ahead) {
        const glm::dvec3 normal = glm::cross(before.ahead, ahead);
        const double sine = glm::length(normal);
        const double angle = std::atan2(sine, glm::dot(before.ahead, ahead));
        // Straight on, or straight back: any axis at right angles will do.
        const glm::dvec3 axis = sine > 1e-12 ? normal / sine : before.side;
        if (angle < kMitred) {
            ring(centre, turned(before, axis, angle / 2), 0);
        } else {
            const int steps = static_cast<int>(std::ceil(angle / kBendStep));
            for (int i = 0; i <= steps; ++i) ring(centre, turned(before, axis, angle * i / steps), 0);
        }
        return {ahead, turned(before, axis, angle).side};
    }

    void vertex(const glm::dvec3& centre, const glm::dvec3& outwards) {
        mesh_.vertices.push_back({.anchor = glm::vec3(centre),
                                  .offset = glm::vec3(style_.radius * outwards),
                                  .normal = glm::vec3(outwards)});
    }
    void triangle(uint32_t a, uint32_t b, uint32_t c) { mesh_.indices.insert(mesh_.indices.end(), {a, b, c}); }

    const TubeStyle& style_;
    OverlayMesh& mesh_;
    bool joined_ = false;  ///< the next ring has one before it to join to
};

/// The middle of the lines' bounding box, on a whole metre.
glm::dvec3 originOf(std::span<const std::vector<glm::dvec3>> lines) {
    glm::dvec3 low(0);
    glm::dvec3 high(0);
    bool any = false;
    for (const auto& line : lines)
        for (const glm::dvec3& point : line) {
            low = any ? glm::min(low, point) : point;
            high = any ? glm::max(high, point) : point;
            any = true;
        }
    return glm::floor((low + high) / 2.0);
}

}  // namespace

OverlayMesh tubeMesh(std::span<const std::vector<glm::dvec3>> lines, const TubeStyle& style) {
    TERRAY_CHECK_OP(style.radius, >, 0);
    TERRAY_CHECK_OP(style.sides, >=, 3);
    OverlayMesh mesh{
        .origin = originOf(lines), .colour = style.colour, .size = style.radius, .leastPixels = style.leastPixels};
    TubeBuilder builder(style, mesh);
    for (const std::vector<glm::dvec3>& line : lines) {
        std::vector<glm::dvec3> points;
        for (const glm::dvec3& point : line) {
            const glm::dvec3 local = point - mesh.origin;
            if (points.empty() || glm::distance(points.back(), local) > style.radius / 16) points.push_back(local);
        }
        if (!points.empty()) builder.add(points);
    }
    return mesh;
}

}  // namespace terray
