#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "client/engine/engine.h"
#include "client/render/gl_context.h"
#include "tests/support/analytic_dataset.h"

namespace terray {

/// Colours as sRGB, 0 .. 255, not rounded.
using Encoded = glm::dvec3;

[[nodiscard]] Encoded encodedFromLinear(const glm::dvec3& linear);
/// 0xRRGGBB as a legend names it.
[[nodiscard]] Encoded legend(uint32_t rgb);
/// What a legend of seven evenly spaced stops shows at a place, 0 at the first and 6 at the last.
[[nodiscard]] Encoded ramp(const std::array<uint32_t, 7>& stops, double place);
/// Greatest difference of a channel.
[[nodiscard]] double distance(const Encoded& a, const Encoded& b);

/// A frame drawn in a shading mode, with all that is known of its pixels, in linear colour over a signal sky.
class ShadedPicture {
  public:
    /// Draws with all tiles that budgets allow, or, with `frames`, as many frames as that without waiting for tiles.
    ShadedPicture(const ShaderLibrary& shaders, const TileSource& source, Shading shading, EngineOptions options,
                  const Camera& camera, int frames = 0);

    [[nodiscard]] const Engine& engine() const { return *engine_; }
    [[nodiscard]] int64_t width() const { return nodes_.width(); }
    [[nodiscard]] int64_t height() const { return nodes_.height(); }
    [[nodiscard]] bool isGround(int64_t x, int64_t y) const { return nodes_.at(x, y) != 0; }
    [[nodiscard]] const DrawNode& node(int64_t x, int64_t y) const { return engine_->nodes().at(nodes_.at(x, y) - 1); }
    [[nodiscard]] const glm::vec4& hit(int64_t x, int64_t y) const { return hits_.at(x, y); }
    [[nodiscard]] glm::dvec3 normal(int64_t x, int64_t y) const { return normals_.at(x, y); }
    /// Place in the dataset, z not exaggerated.
    [[nodiscard]] glm::dvec3 place(int64_t x, int64_t y) const;
    /// As it is shown.
    [[nodiscard]] Encoded colour(int64_t x, int64_t y) const;
    /// Of lit ground: its own colour, the light divided out.
    [[nodiscard]] Encoded tint(int64_t x, int64_t y) const;

  private:
    glm::dvec3 sun_;
    std::unique_ptr<Engine> engine_;
    Grid<uint32_t> nodes_;
    Grid<glm::vec4> hits_;
    Grid<glm::vec3> normals_;
    Grid<glm::vec4> colours_;
};

/// A camera from degrees.
[[nodiscard]] Camera shadedCamera(glm::dvec3 position, double headingDegrees, double pitchDegrees);

}  // namespace terray
