#include "common/edit_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace terray {
namespace {

/// Distances from an edit's line that occur in a rectangle, and more perhaps.
struct DistanceSpan {
    double nearest = 0;
    double farthest = 0;
};

double distanceToRect(glm::dvec2 place, const GroundRect& rect) {
    const double x = std::max({rect.west - place.x, place.x - rect.east, 0.0});
    const double y = std::max({rect.south - place.y, place.y - rect.north, 0.0});
    return std::hypot(x, y);
}

bool meets(const EditSegment& segment, const GroundRect& rect) {
    double from = 0, to = 1;
    const auto clip = [&](double start, double slope, double low, double high) {
        if (slope == 0) {
            if (start < low || start > high) to = -1;
            return;
        }
        const double a = (low - start) / slope, b = (high - start) / slope;
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    };
    clip(segment.from.x, segment.to.x - segment.from.x, rect.west, rect.east);
    clip(segment.from.y, segment.to.y - segment.from.y, rect.south, rect.north);
    return from <= to;
}

/// The distance to a segment is convex: over the rectangle it is greatest at a corner. Where they do not meet it is
/// least at a corner, or at an end of the segment.
DistanceSpan distancesFrom(const EditSegment& segment, const GroundRect& rect) {
    const std::array<glm::dvec2, 4> corners = {glm::dvec2(rect.west, rect.south), glm::dvec2(rect.east, rect.south),
                                               glm::dvec2(rect.west, rect.north), glm::dvec2(rect.east, rect.north)};
    DistanceSpan span{.nearest = std::min(distanceToRect(segment.from, rect), distanceToRect(segment.to, rect))};
    for (const glm::dvec2& corner : corners) {
        const double distance = distanceToSegment(corner, segment);
        span.nearest = std::min(span.nearest, distance);
        span.farthest = std::max(span.farthest, distance);
    }
    if (meets(segment, rect)) span.nearest = 0;
    return span;
}

DistanceSpan distancesFrom(std::span<const EditSegment> line, const GroundRect& rect) {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    DistanceSpan span{kFar, kFar};
    for (const EditSegment& segment : line) {
        const DistanceSpan one = distancesFrom(segment, rect);
        span = {std::min(span.nearest, one.nearest), std::min(span.farthest, one.farthest)};
    }
    return span;
}

/// What a profile over distance does over a span of distances.
struct Profile {
    double least = 0;
    double greatest = 0;
    double slope = 0;  ///< steepest, >= 0, per metre
};

Profile craterProfile(const TerrainEdit& crater, const DistanceSpan& distances) {
    const double near = std::min(distances.nearest / crater.radius, 2.0);
    const double far = std::min(distances.farthest / crater.radius, 2.0);
    const double bowl = crater.height + crater.rim;
    const auto change = [&](double r) {
        return r <= 1 ? bowl * r * r - crater.height : crater.rim * (2 - r) * (2 - r);
    };
    // It rises to the crest and falls from there.
    Profile profile{.least = std::min(change(near), change(far)), .greatest = std::max(change(near), change(far))};
    if (near <= 1 && far >= 1) profile.greatest = crater.rim;
    if (near <= 1) profile.slope = 2 * bowl * std::min(far, 1.0) / crater.radius;
    if (far > 1) profile.slope = std::max(profile.slope, 2 * crater.rim * (2 - std::max(near, 1.0)) / crater.radius);
    return profile;
}

/// Of a stroke's weight, which falls with distance.
Profile weightProfile(const TerrainEdit& stroke, const DistanceSpan& distances) {
    const double width = stroke.radius - stroke.full;
    const auto share = [&](double distance) { return std::clamp((distance - stroke.full) / width, 0.0, 1.0); };
    const double near = share(distances.nearest), far = share(distances.farthest);
    const auto weight = [](double t) { return 1 - t * t * (3 - 2 * t); };
    const double steepest = std::clamp(0.5, near, far);  // 6 t (1 - t) is greatest in the middle
    return {.least = weight(far), .greatest = weight(near), .slope = 6 * steepest * (1 - steepest) / width};
}

}  // namespace

EditBounds editBounds(std::span<const TerrainEdit> edits, const GroundRect& rect, const HeightSpan& before,
                      double apart) {
    EditBounds bounds{.heights = before};
    HeightSpan& heights = bounds.heights;
    for (const TerrainEdit& edit : edits) {
        const DistanceSpan distances = distancesFrom(edit.line, rect);
        if (edit.kind == TerrainEdit::Kind::level) {
            const Profile weight = weightProfile(edit, distances);
            const double pull =
                std::max(std::abs(edit.height - heights.lowest), std::abs(edit.height - heights.highest));
            bounds.variation += pull * std::min(weight.slope * apart, weight.greatest - weight.least);
            const auto drawn = [&](double height) {
                return (1 - weight.greatest) * height + weight.greatest * edit.height;
            };
            heights = {std::min(heights.lowest, drawn(heights.lowest)),
                       std::max(heights.highest, drawn(heights.highest))};
            continue;
        }
        Profile change =
            edit.kind == TerrainEdit::Kind::crater ? craterProfile(edit, distances) : weightProfile(edit, distances);
        if (edit.kind == TerrainEdit::Kind::raise) {
            change = {.least = std::min(change.least * edit.height, change.greatest * edit.height),
                      .greatest = std::max(change.least * edit.height, change.greatest * edit.height),
                      .slope = change.slope * std::abs(edit.height)};
        }
        bounds.variation += std::min(change.slope * apart, change.greatest - change.least);
        heights = {heights.lowest + std::min(change.least, 0.0), heights.highest + std::max(change.greatest, 0.0)};
    }
    return bounds;
}

}  // namespace terray
