#pragma once

#include <glm/vec3.hpp>

#include "common/view.h"

namespace terray {

/// A frame whose axes run along the world's: frame = (world - origin) * scale, axis by axis.
struct AxisFrame {
    glm::dvec3 origin{0};  ///< world, metres
    glm::dvec3 scale{1};   ///< frame units per metre; negative turns the axis round
};

/// The rays of a picture in some frame: pixel (i, j) has the direction first + i right + j down. t is view depth in
/// metres, as in View. Plain values, in float as the casters use them.
struct PictureRays {
    glm::vec3 eye;
    glm::vec3 first;  ///< through the centre of the upper left pixel
    glm::vec3 right;  ///< change from a pixel to the next one
    glm::vec3 down;
    int width;
    int height;
};

[[nodiscard]] inline PictureRays pictureRays(const View& view, const AxisFrame& frame) {
    const glm::dvec3 first = view.direction(0.5, 0.5);
    return {.eye = glm::vec3((view.eye - frame.origin) * frame.scale),
            .first = glm::vec3(first * frame.scale),
            .right = glm::vec3((view.direction(1.5, 0.5) - first) * frame.scale),
            .down = glm::vec3((view.direction(0.5, 1.5) - first) * frame.scale),
            .width = view.width,
            .height = view.height};
}

}  // namespace terray
