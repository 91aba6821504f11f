#include "client/engine/earth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace terray {
namespace {

/// Whether the earth's curvature shows on pictures of a ground, as EarthModel says.
bool shows(const GroundRect& ground, const EarthOptions& options, double tolerancePixels, double focalPixels) {
    const double diagonal = std::hypot(ground.east - ground.west, ground.north - ground.south);
    const EarthCurvature earth = sphericalEarth({.eyeHeight = 0, .refraction = options.refraction});
    return diagonal * earth.xx * focalPixels > tolerancePixels;
}

std::string describe(const std::string& surface, double refraction) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), ", refraction %g", refraction);
    return surface + text.data();
}

}  // namespace

EarthModel::EarthModel(const DatasetMetadata& metadata, const EarthOptions& options, double tolerancePixels,
                       double focalPixels)
    : ground_(metadata.groundBounds()), refraction_(options.refraction), description_("flat") {
    const bool located = !metadata.crsWkt.empty();
    curved_ = options.shape == EarthShape::curved || (options.shape == EarthShape::automatic && located &&
                                                      shows(ground_, options, tolerancePixels, focalPixels));
    if (!curved_) return;
    std::string why = "no coordinate system";
    if (located) {
        auto projection = Projection::create(metadata.crsWkt);
        if (projection) {
            projection_ = std::move(projection).value();
            description_ = describe("WGS 84 under " + metadata.crsName, refraction_);
            return;
        }
        why = projection.failure().message;
    }
    description_ = describe("sphere of the mean radius (" + why + ")", refraction_);
}

std::optional<EarthCurvature> EarthModel::at(const glm::dvec3& eye) const {
    if (!curved_) return {};
    const Sight sight{.eyeHeight = eye.z, .refraction = refraction_};
    if (projection_) {
        const glm::dvec2 place(std::clamp(eye.x, ground_.west, ground_.east),
                               std::clamp(eye.y, ground_.south, ground_.north));
        const auto earth = earthCurvature(*projection_, place, sight);
        if (earth) return *earth;  // else the dataset reaches beyond its own projection
    }
    return sphericalEarth(sight);
}

}  // namespace terray
