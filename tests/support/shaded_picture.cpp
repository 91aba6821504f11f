#include "tests/support/shaded_picture.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace terray {

Encoded encodedFromLinear(const glm::dvec3& linear) {
    Encoded out;
    for (int i = 0; i < 3; ++i) {
        const double c = linear[i];
        out[i] = 255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055);
    }
    return out;
}

Encoded legend(uint32_t rgb) {
    return {rgb >> 16 & 255, rgb >> 8 & 255, rgb & 255};
}

Encoded ramp(const std::array<uint32_t, 7>& stops, double place) {
    const double inside = std::clamp(place, 0.0, 6.0);
    const auto below = std::min<size_t>(static_cast<size_t>(inside), 5);
    return glm::mix(legend(stops[below]), legend(stops[below + 1]), inside - static_cast<double>(below));
}

double distance(const Encoded& a, const Encoded& b) {
    const glm::dvec3 difference = glm::abs(a - b);
    return std::max({difference.x, difference.y, difference.z});
}

ShadedPicture::ShadedPicture(const ShaderLibrary& shaders, const TileSource& source, Shading shading,
                             EngineOptions options, const Camera& camera, int frames) {
    options.render.shading.mode = shading;
    options.colour = ColourFormat::linearFloat;
    options.features.signalSky = options.features.normals = true;
    sun_ = glm::normalize(options.render.sunDirection);
    engine_ = std::make_unique<Engine>(source, shaders, options, 160, 120);
    if (frames == 0) engine_->drawFrame(camera, true);
    for (int n = 0; n < frames; ++n) engine_->drawFrame(camera, false);
    nodes_ = engine_->targets().readNodes();
    hits_ = engine_->targets().readHits();
    normals_ = engine_->targets().readNormals();
    colours_ = engine_->targets().readLinear();
}

glm::dvec3 ShadedPicture::place(int64_t x, int64_t y) const {
    return engine_->worldFromHit(node(x, y), hit(x, y));
}

Encoded ShadedPicture::colour(int64_t x, int64_t y) const {
    return encodedFromLinear(glm::dvec3(colours_.at(x, y)));
}

Encoded ShadedPicture::tint(int64_t x, int64_t y) const {
    // The light of shaders/daylight.glsl.
    const glm::dvec3 sun(1.22, 1.16, 1.08), sky(0.22, 0.25, 0.30);
    const glm::dvec3 light = sun * std::max(glm::dot(normal(x, y), sun_), 0.0) + sky * (0.5 + 0.5 * normal(x, y).z);
    return encodedFromLinear(glm::dvec3(colours_.at(x, y)) / light);
}

Camera shadedCamera(glm::dvec3 position, double headingDegrees, double pitchDegrees) {
    return {.position = position,
            .heading = radiansFromDegrees(headingDegrees),
            .pitch = radiansFromDegrees(pitchDegrees),
            .verticalFov = radiansFromDegrees(60)};
}

}  // namespace terray
