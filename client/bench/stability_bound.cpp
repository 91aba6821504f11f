#include "client/bench/stability_bound.h"

#include <algorithm>
#include <cmath>

namespace terray {
namespace {

constexpr double kRoundings = 24;
constexpr double kCodes = 65536;
constexpr double kSingle = 0x1p-24;
constexpr double kDouble = 0x1p-53;

bool isFinite(const DrawnPixel& drawn) {
    return std::isfinite(drawn.depth) && std::isfinite(drawn.place.x) && std::isfinite(drawn.place.y) &&
           std::isfinite(drawn.place.z);
}

}  // namespace

StabilityBound stabilityBound(const View& view, const BoundTerms& terms) {
    const double unit = kRoundings * (terms.precision == Precision::single ? kSingle : kDouble);
    const double exact = kRoundings * kDouble * terms.coordinates;
    const double growth = unit * (1 + view.tanHalfWidth() + view.tanHalfHeight);
    const Slack::Line across{unit * terms.tileSide + exact, growth};
    const double doubled = terms.codeStep > terms.quantum ? terms.codeStep : 0;
    const double spread = growth / unit;
    const double bend =
        view.earth ? unit * spread * spread * (view.earth->xx + std::abs(view.earth->xy) + view.earth->yy) : 0;

    StabilityBound bound;
    bound.slack.height = {unit * kCodes * terms.codeStep + exact + doubled + terms.relief, growth / view.exaggeration};
    bound.slack.heightBend = bend / view.exaggeration;
    bound.slack.edge = {across.a / terms.spacing, across.b / terms.spacing};
    bound.slack.reach = bound.slack.edge;
    if (terms.columns) bound.slack.reach.a += 0.5;
    bound.place = across;
    bound.place.a = std::max(across.a, view.exaggeration * unit * kCodes * terms.codeStep + exact);
    bound.placeBend = bend;
    return bound;
}

RayVerdict judgeRay(const GroundCaster& truth, const View& view, const glm::ivec2& pixel, const DrawnPixel& drawn,
                    const StabilityBound& bound, double lowest) {
    const glm::dvec3 direction = view.direction(pixel.x + 0.5, pixel.y + 0.5);
    const auto shrunk = truth.meetExtreme(view, direction, bound.slack, Extreme::shrunk, truth.floor());
    if (!drawn.ground) return shrunk ? RayVerdict::seeThrough : RayVerdict::right;
    if (!isFinite(drawn)) return RayVerdict::notANumber;
    const auto grown = truth.meetExtreme(view, direction, bound.slack, Extreme::grown, lowest);
    if (!grown) return RayVerdict::coversSky;

    // Of t itself: the rounding of the last sum. All else displaces the ray.
    const double rounding = bound.place.b * drawn.depth;
    if (drawn.depth < *grown - rounding) return RayVerdict::misplaced;
    if (shrunk && drawn.depth > *shrunk + rounding) return RayVerdict::misplaced;
    glm::dvec3 place = drawn.place;
    place.z *= view.exaggeration;
    const glm::dvec3 off = glm::abs(place - view.at(direction, drawn.depth));
    const double allowed = bound.place.at(drawn.depth) + bound.placeBend * drawn.depth * drawn.depth;
    return std::max({off.x, off.y, off.z}) <= allowed ? RayVerdict::right : RayVerdict::misplaced;
}

}  // namespace terray
