#pragma once

#include <memory>
#include <string>

#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>

#include "common/geodesy.h"
#include "common/result.h"

namespace terray {

/// Conversion between a dataset's plane coordinates (metres, x east, y north) and WGS 84 longitude and latitude, by
/// PROJ. One object serves one thread at a time. Built without PROJ (TERRAY_WITH_PROJ=0), creation fails and says so.
class Projection {
  public:
    /// @param crs  WKT2, or anything PROJ takes such as "EPSG:32613"
    [[nodiscard]] static Result<Projection> create(const std::string& crs);
    Projection(Projection&&) noexcept;
    Projection& operator=(Projection&&) noexcept;
    ~Projection();

    [[nodiscard]] Result<LonLat> lonLat(glm::dvec2 plane) const;
    [[nodiscard]] Result<glm::dvec2> plane(LonLat place) const;
    /// Angle from grid north (the y axis) to true north at a place, clockwise positive: a true heading of a is the grid
    /// heading a + convergence. From a step of 1e-6 degrees to the north, so good to about 1e-6 radians.
    [[nodiscard]] Result<Radians> gridHeadingOfNorth(glm::dvec2 plane) const;
    /// Metres on the ground to the true east and north (rows) for a metre of the plane along x and along y (columns) at
    /// a place: scale, convergence and shear of the projection. From lines of 20 m, good to about 1e-8.
    [[nodiscard]] Result<glm::dmat2> groundFromPlane(glm::dvec2 plane) const;

  private:
    struct State;
    explicit Projection(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace terray
