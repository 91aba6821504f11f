#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

namespace terray {

/// A corner of a triangle: it lies at the mesh's origin + anchor + offset. World axes (east, north, up), metres.
struct OverlayVertex {
    glm::vec3 anchor{0};
    glm::vec3 offset{0};  ///< from the thing's place or middle line; what grows when the mesh would be drawn too thin
    glm::vec3 normal{0, 0, 1};  ///< unit, outwards
};

/// Triangles that are drawn into the picture of a terrain: the plain value in which what makes them (client/overlay)
/// and what draws them (client/render) meet. Surfaces are closed; corners run counter-clockwise as seen from outside.
///
/// Places are doubles in `origin` and floats from there, so they are good to 2^-24 of the distance from it: 3 cm at 500
/// km.
struct OverlayMesh {
    glm::dvec3 origin{0};  ///< world, metres
    glm::vec3 colour{1};   ///< linear, 0..1
    std::vector<OverlayVertex> vertices;
    std::vector<uint32_t> indices;  ///< three a triangle
    /// Offsets are drawn longer where else `size` metres would span fewer than `leastPixels`, so that the thing stays
    /// visible from afar. 0: never.
    double size = 1;
    double leastPixels = 0;
};

}  // namespace terray
