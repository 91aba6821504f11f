#pragma once

#include <cmath>

#include "client/navigation/navigator.h"
#include "common/earth_curvature.h"

namespace terray::test {

/// Ground in closed form, without end: hills of up to 1000 m, or level.
class Hills final : public Ground {
  public:
    explicit Hills(double height = 500) : height_(height) {}
    [[nodiscard]] double heightAt(glm::dvec2 place) const {
        return height_ * (1 + std::sin(place.x / 700) * std::cos(place.y / 900));
    }
    [[nodiscard]] std::optional<GroundHeight> under(glm::dvec2 place) override {
        return GroundHeight{heightAt(place), 0};
    }

  private:
    double height_;
};

inline constexpr GroundRect kExtent{0, 0, 20000, 20000};

inline View drawn(const Camera& camera, double exaggeration = 1, std::optional<EarthCurvature> earth = {}) {
    View view = viewOf(camera, 640, 480);
    view.earth = earth;
    return exaggerated(view, exaggeration);
}

inline NavigationScene sceneOver(Ground& ground, double exaggeration = 1) {
    return {.ground = &ground,
            .extent = kExtent,
            .lowest = 0,
            .highest = 1000,
            .view = [exaggeration](const Camera& camera) { return drawn(camera, exaggeration); }};
}

}  // namespace terray::test
