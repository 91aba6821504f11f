#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <glm/vec3.hpp>

#include "common/dataset_metadata.h"
#include "common/earth_curvature.h"
#include "common/projection.h"

namespace terray {

enum class EarthShape : uint8_t {
    automatic,  ///< curved where it would show, see EarthModel
    flat,       ///< the map as it is: nothing of the curved earth is compiled
    curved,
};

struct EarthOptions {
    EarthShape shape = EarthShape::automatic;
    double refraction = kStandardRefraction;  ///< k, -10 .. below 1
    bool operator==(const EarthOptions&) const = default;
};

/// Decides whether a dataset is drawn over a curved earth, and knows how that curves at each eye.
///
/// Automatic: curved when the dataset has a coordinate system and, from one corner of it to the opposite one, the earth
/// moves the ground on the picture by more than the tolerance of heights: (1 - k) D / 2 R radians over a diagonal D.
/// With 720 rows, 45 degrees and 2/3 pixel that is D > 11.2 km. Decided once, from the options and not from the camera,
/// so that a flight has one shape from its first frame to its last.
class EarthModel {
  public:
    /// @param tolerancePixels  of heights  @param focalPixels  pixels per unit of slope of the pictures to be drawn
    EarthModel(const DatasetMetadata& metadata, const EarthOptions& options, double tolerancePixels,
               double focalPixels);

    [[nodiscard]] bool curved() const { return curved_; }
    /// For an eye at a place of the map, at the nearest place of the dataset if it lies outside; none if flat.
    [[nodiscard]] std::optional<EarthCurvature> at(const glm::dvec3& eye) const;
    /// For people: "flat", or what the curvature is made from.
    [[nodiscard]] const std::string& description() const { return description_; }

  private:
    GroundRect ground_;
    double refraction_;
    bool curved_ = false;
    std::optional<Projection> projection_;  ///< none: a sphere
    std::string description_;
};

}  // namespace terray
