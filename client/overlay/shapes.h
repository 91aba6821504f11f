#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "common/overlay_mesh.h"

namespace terray {

/// How a tube is made.
struct TubeStyle {
    double radius = 5;  ///< metres, > 0
    int sides = 8;      ///< of its cross-section, >= 3
    /// The radius spans at least so many pixels.
    double leastPixels = 0;
    glm::vec3 colour{1};
};

/// Round tubes along lines, closed by half balls at their ends, all in one mesh.
///
/// The tube keeps its radius everywhere: at a corner the cross-section turns about the corner in steps of up to 30
/// degrees, like the bend of a hose, so neither sharp corners nor turns back pinch it or send out spikes (corners of
/// less than 5 degrees are mitred, which thins it by 0.1 %). What is seen of it lies at most the radius away from the
/// lines, and not nearer than radius cos(180 degrees / sides) along them, cos(15 degrees) of that at corners and ends.
/// A line of one point is a ball. Points nearer to the last one than radius / 16 are left out.
/// @param lines  world, metres; without any point the mesh is empty
[[nodiscard]] OverlayMesh tubeMesh(std::span<const std::vector<glm::dvec3>> lines, const TubeStyle& style);

/// A pin of a map: a ball on a cone whose tip is at a place. @param height  of the whole, metres, > 0
[[nodiscard]] OverlayMesh pinMesh(const glm::dvec3& tip, double height, const glm::vec3& colour);

/// A cube along the axes. @param base  centre of its lowest face  @param side  metres, > 0
[[nodiscard]] OverlayMesh cubeMesh(const glm::dvec3& base, double side, const glm::vec3& colour);

}  // namespace terray
