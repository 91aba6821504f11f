#include "common/terrain_edit.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "common/check.h"

namespace terray {
namespace {

constexpr double kMostCoordinate = 1e9;

double distanceToLine(glm::dvec2 place, std::span<const EditSegment> line) {
    double nearest = distanceToSegment(place, line.front());
    for (const EditSegment& segment : line.subspan(1)) nearest = std::min(nearest, distanceToSegment(place, segment));
    return nearest;
}

/// Whether a segment's bounding rectangle comes nearer to a rectangle than `reach`.
bool mayReach(const EditSegment& segment, const GroundRect& rect, double reach) {
    const glm::dvec2 low = glm::min(segment.from, segment.to), high = glm::max(segment.from, segment.to);
    const double x = std::max({rect.west - high.x, low.x - rect.east, 0.0});
    const double y = std::max({rect.south - high.y, low.y - rect.north, 0.0});
    return std::hypot(x, y) < reach;
}

double strokeWeight(double distance, double full, double radius) {
    const double t = std::clamp((distance - full) / (radius - full), 0.0, 1.0);
    return 1 - t * t * (3 - 2 * t);
}

double craterChange(const TerrainEdit& crater, double distance) {
    const double r = distance / crater.radius;
    if (r <= 1) return (crater.height + crater.rim) * (r * r) - crater.height;
    return crater.rim * ((2 - r) * (2 - r));
}

bool valid(const TerrainEdit& edit) {
    const auto within = [](double value, double least, double most) { return value >= least && value <= most; };
    for (const EditSegment& segment : edit.line)
        for (const double coordinate : {segment.from.x, segment.from.y, segment.to.x, segment.to.y})
            if (!within(coordinate, -kMostCoordinate, kMostCoordinate)) return false;
    const bool crater = edit.kind == TerrainEdit::Kind::crater;
    if (crater && (edit.line.size() != 1 || edit.line[0].from != edit.line[0].to || edit.height < 0)) return false;
    return !edit.line.empty() && edit.radius > 0 && edit.radius <= kMostEditMetres && edit.full >= 0 &&
           edit.full < edit.radius && within(edit.height, -kMostEditMetres, kMostEditMetres) &&
           within(edit.rim, 0, kMostEditMetres);
}

}  // namespace

bool valid(std::span<const TerrainEdit> edits) {
    double moved = 0;
    for (const TerrainEdit& edit : edits) {
        if (!valid(edit)) return false;
        if (edit.kind != TerrainEdit::Kind::level) moved += std::abs(edit.height) + edit.rim;
    }
    return moved <= kMostEditMetres;
}

std::vector<EditSegment> segmentsThrough(std::span<const glm::dvec2> points) {
    TERRAY_CHECK(!points.empty());
    if (points.size() == 1) return {{points[0], points[0]}};
    std::vector<EditSegment> line;
    for (size_t i = 0; i + 1 < points.size(); ++i) line.push_back({points[i], points[i + 1]});
    return line;
}

double distanceToSegment(glm::dvec2 place, const EditSegment& segment) {
    const glm::dvec2 along = segment.to - segment.from, offset = place - segment.from;
    const double squared = glm::dot(along, along);
    const double share = squared > 0 ? std::clamp(glm::dot(offset, along) / squared, 0.0, 1.0) : 0.0;
    return glm::length(offset - share * along);
}

double reachOf(const TerrainEdit& edit) {
    return edit.kind == TerrainEdit::Kind::crater ? 2 * edit.radius : edit.radius;
}

double editedHeight(double height, glm::dvec2 place, std::span<const TerrainEdit> edits) {
    for (const TerrainEdit& edit : edits) {
        const double distance = distanceToLine(place, edit.line);
        if (distance >= reachOf(edit)) continue;
        if (edit.kind == TerrainEdit::Kind::crater) {
            height += craterChange(edit, distance);
            continue;
        }
        const double weight = strokeWeight(distance, edit.full, edit.radius);
        const bool level = edit.kind == TerrainEdit::Kind::level;
        height = (level ? 1 - weight : 1) * height + weight * edit.height;
    }
    return height;
}

EditList editsNear(std::span<const TerrainEdit> edits, const GroundRect& rect) {
    EditList near;
    std::vector<EditSegment> line;
    for (const TerrainEdit& edit : edits) {
        line.clear();
        for (const EditSegment& segment : edit.line)
            if (mayReach(segment, rect, reachOf(edit))) line.push_back(segment);
        if (line.empty()) continue;
        near.push_back({.kind = edit.kind,
                        .line = line,
                        .radius = edit.radius,
                        .full = edit.full,
                        .height = edit.height,
                        .rim = edit.rim});
    }
    return near;
}

GroundRect footprint(const TerrainEdit& edit) {
    glm::dvec2 low = edit.line.front().from, high = low;
    for (const EditSegment& segment : edit.line) {
        low = glm::min(low, glm::min(segment.from, segment.to));
        high = glm::max(high, glm::max(segment.from, segment.to));
    }
    return widened({low.x, low.y, high.x, high.y}, reachOf(edit));
}

}  // namespace terray
