#pragma once

#include <optional>

#include <glm/vec3.hpp>

#include "common/earth_curvature.h"
#include "common/grid.h"

namespace terray {

/// What a picture is taken with, in world coordinates: what selection, renderer and truth agree on.
///
/// World: x east, y north, z up, metres of the dataset's coordinate system. The ray through the centre of pixel (i, j),
/// j counted from the top, is P(t) = eye + t * direction with
///     direction = forward + (2 (i + 0.5) / width - 1) tanHalfWidth right + (1 - 2 (j + 0.5) / height) tanHalfHeight
///     up,
/// not normalised: t is then the distance along the view axis (view depth) in metres. Over a curved earth P(t) is
/// higher than that by the drop at its place (common/earth_curvature.h).
///
/// Exaggerated, z of this world is `exaggeration` times the height in the dataset, for eye, ground and drop alike: what
/// hides what from the eye is as it was, and an eye near the ground stays near it. Bounds and errors of tiles, whatever
/// is stored, and camera positions stay heights.
///
/// Where only a part of the picture is drawn, all else still tells of the whole picture, so that parts side by side are
/// the picture: the same rays, sizes in pixels and levels of detail.
struct View {
    glm::dvec3 eye{0};
    glm::dvec3 right{1, 0, 0};  ///< right, up, forward: orthonormal, right-handed (right x up = -forward)
    glm::dvec3 up{0, 0, 1};
    glm::dvec3 forward{0, 1, 0};
    double tanHalfHeight = 0.5;           ///< tangent of half the vertical field of view
    int width = 1;                        ///< pixels
    int height = 1;                       ///< pixels
    std::optional<EarthCurvature> earth;  ///< of this world, so exaggerated; none: a flat earth
    double exaggeration = 1;              ///< z over height, > 0
    std::optional<GridRect> part;         ///< what is drawn, rows from the top; none: all of the picture

    [[nodiscard]] double tanHalfWidth() const { return tanHalfHeight * width / height; }
    /// What is drawn, all of the picture or its part.
    [[nodiscard]] GridRect drawn() const { return part.value_or(GridRect{0, 0, width, height}); }
    /// Pixels per unit of slope on the image axis: an object of size s at view depth d covers s / d * focalPixels().
    [[nodiscard]] double focalPixels() const { return height / (2 * tanHalfHeight); }
    /// Direction of the ray through a point of the picture, in pixels from the upper-left corner (centres at +0.5).
    [[nodiscard]] glm::dvec3 direction(double pixelX, double pixelY) const {
        return forward + (2 * pixelX / width - 1) * tanHalfWidth() * right +
               (1 - 2 * pixelY / height) * tanHalfHeight * up;
    }
    /// P(t) of a ray.
    [[nodiscard]] glm::dvec3 at(const glm::dvec3& direction, double t) const {
        glm::dvec3 place = eye + t * direction;
        if (earth) place.z += earth->drop(t * direction.x, t * direction.y);
        return place;
    }
};

/// The least and the greatest exaggeration: beyond them floats relative to a tile lose the ground.
inline constexpr double kLeastExaggeration = 0.01;
inline constexpr double kGreatestExaggeration = 100;

/// A view of heights as a view of the same place with all heights multiplied.
[[nodiscard]] inline View exaggerated(View view, double factor) {
    view.eye.z *= factor;
    view.exaggeration *= factor;
    if (view.earth)
        view.earth = EarthCurvature{view.earth->xx * factor, view.earth->xy * factor, view.earth->yy * factor};
    return view;
}

}  // namespace terray
