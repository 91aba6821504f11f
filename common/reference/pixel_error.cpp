#include "common/reference/pixel_error.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <thread>

#include <glm/geometric.hpp>

#include "common/parallel.h"

namespace terray {
namespace {

/// Where a place is seen on the picture, in pixels from its centre; what is behind the eye has none.
std::optional<glm::dvec2> seenAt(const View& view, glm::dvec3 place) {
    glm::dvec3 fromEye = place - view.eye;
    if (view.earth) fromEye.z -= view.earth->drop(fromEye.x, fromEye.y);
    const double depth = glm::dot(fromEye, view.forward);
    if (!(depth > 0)) return std::nullopt;
    const double scale = view.focalPixels() / depth;
    return scale * glm::dvec2(glm::dot(fromEye, view.right), glm::dot(fromEye, view.up));
}

/// How long the way from a drawn point straight up or down to the ground is on the picture; from one beyond the
/// ground's edge, the way to its side or, above that, to the edge.
std::optional<double> verticalPixels(const GroundCaster& truth, const View& view, const glm::dvec3& place) {
    glm::dvec3 foot = place;
    if (const std::optional<double> height = truth.heightAt(place.x, place.y)) {
        foot.z = *height;
    } else {
        const std::optional<glm::dvec3> edge = truth.nearestEdge(place.x, place.y);
        if (!edge) return std::nullopt;
        foot = {edge->x, edge->y, std::min(place.z, edge->z)};
    }
    const auto seen = [&](const glm::dvec3& at) { return seenAt(view, {at.x, at.y, at.z * view.exaggeration}); };
    const auto drawn = seen(place);
    const auto ground = seen(foot);
    if (!drawn || !ground) return std::nullopt;
    return glm::length(*drawn - *ground);
}

/// Whether a ray meets the ground at its side: below its surface, or where rounding puts the place just outside.
bool onSide(const GroundCaster& truth, const View& view, const glm::dvec3& direction, double depth) {
    const glm::dvec3 place = view.at(direction, depth);
    const std::optional<double> height = truth.heightAt(place.x, place.y);
    // A contact with the surface is off by some last places of the depth, times the ground's slope.
    constexpr double kShareOfDepth = 1e-6;
    return !height || place.z / view.exaggeration < *height - kShareOfDepth * depth;
}

}  // namespace

PixelError pixelError(const GroundCaster& truth, const View& view, const glm::ivec2& pixel, const DrawnPixel& drawn) {
    const glm::dvec3 direction = view.direction(pixel.x + 0.5, pixel.y + 0.5);
    const std::optional<double> depth = truth.meet(view, direction);
    if (!depth || !drawn.ground) {
        const bool side = depth && onSide(truth, view, direction, *depth);
        if (depth) return {.kind = side ? PixelError::Kind::base : PixelError::Kind::seeThrough, .trueDepth = *depth};
        if (!drawn.ground) return {.kind = PixelError::Kind::sky};
        return {.kind = drawn.place.z < truth.floor() ? PixelError::Kind::base : PixelError::Kind::coversSky};
    }
    const double metres = std::abs(drawn.depth - *depth);
    const double alongRay =
        metres * glm::length(direction) * view.focalPixels() / std::max(std::min(drawn.depth, *depth), 1e-9);
    const double vertical = verticalPixels(truth, view, drawn.place).value_or(alongRay);
    return {.kind = PixelError::Kind::ground,
            .pixels = static_cast<float>(std::min(vertical, alongRay)),
            .depthMetres = static_cast<float>(metres),
            .depthRelative = static_cast<float>(metres / std::max(*depth, 1e-9)),
            .trueDepth = *depth};
}

std::vector<PixelError> pixelErrors(const GroundCaster& truth, const View& view, std::span<const glm::ivec2> pixels,
                                    std::span<const DrawnPixel> drawn) {
    TERRAY_CHECK_OP(pixels.size(), ==, drawn.size());
    constexpr size_t kAtATime = 256;
    std::vector<PixelError> errors(pixels.size());
    const std::atomic<bool> never = false;
    const auto cores = static_cast<int>(std::max(std::thread::hardware_concurrency(), 1U));
    forEachParallel((pixels.size() + kAtATime - 1) / kAtATime, cores, never, [&](int, size_t part) {
        const size_t end = std::min((part + 1) * kAtATime, pixels.size());
        for (size_t n = part * kAtATime; n < end; ++n) errors[n] = pixelError(truth, view, pixels[n], drawn[n]);
    });
    return errors;
}

void ErrorTotals::add(std::span<const PixelError> errors) {
    pixels += errors.size();
    for (const PixelError& error : errors) {
        seeThrough += error.kind == PixelError::Kind::seeThrough ? 1 : 0;
        coversSky += error.kind == PixelError::Kind::coversSky ? 1 : 0;
        if (error.kind != PixelError::Kind::ground) continue;
        errorPixels.push_back(error.pixels);
        depthMetres.push_back(error.depthMetres);
        depthRelative.push_back(error.depthRelative);
    }
}

}  // namespace terray
