#pragma once

#include <optional>

#include <glm/vec2.hpp>

namespace terray {

/// What is known of the ground at a place.
struct GroundHeight {
    double height = 0;       ///< metres, as the dataset counts them
    double uncertainty = 0;  ///< the finest ground lies higher by at most this; 0: this is the finest
};

/// The ground that a camera must stay above.
class Ground {
  public:
    virtual ~Ground() = default;
    /// Answers at once with what is known by now. None where there is no surface.
    [[nodiscard]] virtual std::optional<GroundHeight> under(glm::dvec2 place) = 0;
    /// Whether more will be known soon of places that were asked about.
    [[nodiscard]] virtual bool learning() { return false; }
};

}  // namespace terray
