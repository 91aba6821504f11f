#include "client/navigation/grab.h"

#include <cmath>

#include <glm/geometric.hpp>

namespace terray {
namespace {

double drop(const View& view, const glm::dvec3& offset) {
    return view.earth ? view.earth->drop(offset.x, offset.y) : 0;
}

}  // namespace

glm::dvec3 seenOffset(const View& view, const glm::dvec3& point) {
    glm::dvec3 offset = point - view.eye;
    offset.z -= drop(view, offset);
    return offset;
}

glm::dvec3 eyeSeeing(const View& view, const glm::dvec3& point, const glm::dvec3& offset) {
    glm::dvec3 eye = point - offset;
    eye.z -= drop(view, offset);
    return eye;
}

std::optional<glm::dvec2> pixelOf(const View& view, const glm::dvec3& point) {
    const glm::dvec3 offset = seenOffset(view, point);
    const double depth = glm::dot(offset, view.forward);
    if (!(depth > 0)) return {};
    const double x = glm::dot(offset, view.right) / (depth * view.tanHalfWidth());
    const double y = glm::dot(offset, view.up) / (depth * view.tanHalfHeight);
    return glm::dvec2((x + 1) / 2 * view.width, (1 - y) / 2 * view.height);
}

std::optional<glm::dvec3> eyeDragged(const View& view, const glm::dvec3& grabbed, glm::dvec2 pixel) {
    // The ray of the pixel must be at the grabbed height when it is over the grabbed place:
    // curve t^2 + rise t = climb, where curve is how fast a bent ray gains height.
    const glm::dvec3 ray = view.direction(pixel.x, pixel.y);
    const double curve = drop(view, ray), rise = ray.z, climb = grabbed.z - view.eye.z;
    const double discriminant = rise * rise + 4 * curve * climb;
    if (discriminant < 0) return {};
    // Of two meetings the nearer one; written so that nothing is lost as curve goes to 0.
    const double root = std::sqrt(discriminant);
    const double t = climb < 0 ? -2 * climb / (root - rise) : 2 * climb / (rise + root);
    const double reach = kFarthestDrag * glm::length(grabbed - view.eye);
    if (!(t > 0) || t * glm::length(ray) > reach) return {};
    return glm::dvec3(grabbed.x - t * ray.x, grabbed.y - t * ray.y, view.eye.z);
}

glm::dvec3 eyeOrbited(const View& view, const View& turned, const glm::dvec3& pivot) {
    const glm::dvec3 offset = seenOffset(view, pivot);
    return eyeSeeing(view, pivot,
                     glm::dot(offset, view.right) * turned.right + glm::dot(offset, view.up) * turned.up +
                         glm::dot(offset, view.forward) * turned.forward);
}

glm::dvec3 eyeZoomed(const View& view, const glm::dvec3& point, double factor) {
    return eyeSeeing(view, point, factor * seenOffset(view, point));
}

}  // namespace terray
