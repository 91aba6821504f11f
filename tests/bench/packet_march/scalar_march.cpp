#include "tests/bench/packet_march/scalar_march.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "shaders/math/math.h"

namespace terray {
namespace {

constexpr ScalarHit kNoHit = {std::numeric_limits<double>::infinity(), 0};

/// A ray mirrored so that it runs towards larger x and y.
struct MirroredRay {
    mathd::vec3 eye;
    mathd::vec3 direction;
    mathd::vec3 inverse;
    bool mirroredX;
    bool mirroredY;
};

MirroredRay mirror(const MapRay& ray, int side) {
    MirroredRay out{.eye = mathd::vec3(ray.eye),
                    .direction = mathd::vec3(ray.direction),
                    .inverse = {},
                    .mirroredX = ray.direction.x < 0,
                    .mirroredY = ray.direction.y < 0};
    if (out.mirroredX) out.eye.x = side - out.eye.x;
    if (out.mirroredY) out.eye.y = side - out.eye.y;
    out.direction.x = std::abs(out.direction.x);
    out.direction.y = std::abs(out.direction.y);
    out.inverse = {mathd::safeInverse(out.direction.x), mathd::safeInverse(out.direction.y),
                   mathd::safeInverse(out.direction.z)};
    return out;
}

/// The ray's way through one patch, from `enter` for `span`, against the patch as it is stored.
double patchContact(const PyramidView& map, const MirroredRay& ray, mathd::ivec2 cell, double enter, double span) {
    const int last = (1 << map.coarsest) - 1;
    const int64_t x = ray.mirroredX ? last - cell.x : cell.x;
    const int64_t y = ray.mirroredY ? last - cell.y : cell.y;
    const GridView<const uint16_t> codes(map.codes, {map.width, map.height});
    const mathd::Corners corners{static_cast<double>(codes.at(x, y)), static_cast<double>(codes.at(x + 1, y)),
                                 static_cast<double>(codes.at(x, y + 1)), static_cast<double>(codes.at(x + 1, y + 1))};
    mathd::vec3 at = ray.eye + enter * ray.direction;
    at.x = std::clamp(at.x - cell.x, 0.0, 1.0);
    at.y = std::clamp(at.y - cell.y, 0.0, 1.0);
    mathd::vec3 direction = ray.direction;
    if (ray.mirroredX) {
        at.x = 1 - at.x;
        direction.x = -direction.x;
    }
    if (ray.mirroredY) {
        at.y = 1 - at.y;
        direction.y = -direction.y;
    }
    return mathd::firstContact(mathd::patchClearance(corners, at, direction, 0), span);
}

/// Greatest code of the block of a level that holds a (mirrored) cell.
double blockTop(const HeightPyramid& pyramid, const MirroredRay& ray, mathd::ivec2 cell, int level) {
    const int last = (1 << pyramid.view().coarsest) - 1;
    const int x = ray.mirroredX ? last - cell.x : cell.x;
    const int y = ray.mirroredY ? last - cell.y : cell.y;
    return pyramid.maxima(level).at(x >> level, y >> level);
}

}  // namespace

ScalarHit scalarMarch(const HeightPyramid& pyramid, const MapRay& mapRay) {
    const PyramidView& map = pyramid.view();
    const int side = 1 << map.coarsest;
    const MirroredRay ray = mirror(mapRay, side);
    const mathd::ivec2 low(ray.mirroredX ? side - (map.width - 1) : 0, ray.mirroredY ? side - (map.height - 1) : 0);
    const mathd::ivec2 high(low.x + map.width - 1, low.y + map.height - 1);
    const mathd::vec3 boxMin(low.x, low.y, -1e30);  // solid ground
    const mathd::vec3 boxMax(high.x, high.y, map.maxima[0]);
    const mathd::Interval box = mathd::boxInterval(ray.eye, ray.inverse, boxMin, boxMax);
    if (!(box.enter <= box.exit)) return kNoHit;

    const mathd::vec2 eye(ray.eye.x, ray.eye.y);
    const mathd::vec2 direction(ray.direction.x, ray.direction.y);
    double t = box.enter;
    mathd::ivec2 cell = mathd::cellAt(t, low, high, eye, direction);
    int level = map.start;
    for (int steps = 1;; ++steps) {
        const mathd::ivec2 edge = mathd::blockEdge(cell, level);
        const mathd::vec2 times = mathd::edgeTimes(edge, eye, {ray.inverse.x, ray.inverse.y});
        const double leave = std::max(t, std::min({times.x, times.y, box.exit}));
        if (level > 0) {
            const double top = blockTop(pyramid, ray, cell, level);
            if (mathd::meetsColumn(top, ray.eye.z, ray.direction.z, t, leave)) {
                t = mathd::columnTime(top, ray.eye.z, ray.direction.z, ray.inverse.z, t, leave);
                cell = mathd::cellAt(t, cell, edge, eye, direction);
                --level;
                continue;
            }
        } else {
            const double contact = patchContact(map, ray, cell, t, leave - t);
            if (contact >= 0) return {t + contact, steps};
        }
        if (leave >= box.exit) return {kNoHit.t, steps};
        cell = mathd::cellAfter(cell, edge, times, eye, direction);
        level = mathd::levelAfter(level, map.coarsest, edge, times);
        t = leave;
    }
}

}  // namespace terray
