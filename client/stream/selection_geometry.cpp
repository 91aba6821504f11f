#include "client/stream/selection_geometry.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "common/check.h"

namespace terray {
namespace {

Ground groundOf(const HeightRecord& record) {
    if (!record.exists) return {};
    return {.surface = true,
            .hasHoles = record.hasHoles,
            .low = double{record.minHeight} - record.error,
            .high = double{record.maxHeight} + record.error,
            .bottom = record.minHeight,
            .top = record.maxHeight};
}

/// The square (dx, dy) away from a tile; none beyond the root square.
std::optional<TileId> neighbour(const TileId& id, int dx, int dy) {
    const int64_t side = int64_t{1} << id.level;
    const int64_t x = int64_t{id.x} + dx, y = int64_t{id.y} + dy;
    if (x < 0 || x >= side || y < 0 || y >= side) return {};
    return TileId{id.level, static_cast<uint32_t>(x), static_cast<uint32_t>(y)};
}

}  // namespace

Box boxOf(const TileId& cell, const HeightRange& heights, const Tiling& tiling) {
    const GroundRect ground = tiling.bounds(cell);
    return {{ground.west, ground.south, heights.min}, {ground.east, ground.north, heights.max}};
}

Box seenBoxOf(const TileId& cell, const HeightRange& heights, const Tiling& tiling, const View& view) {
    Box box = boxOf(cell, {view.exaggeration * heights.min, view.exaggeration * heights.max}, tiling);
    if (!view.earth) return box;
    const DropRange drop = dropOver(*view.earth, tiling.bounds(cell), glm::dvec2(view.eye));
    box.min.z -= drop.greatest;
    box.max.z -= drop.least;
    return box;
}

Metres distanceTo(const Box& box, const glm::dvec3& point) {
    return Metres(glm::length(glm::max(glm::max(box.min - point, point - box.max), glm::dvec3(0))));
}

Frustum::Frustum(const View& view) : eye_(view.eye) {
    // Slopes of the rays at the edges.
    const GridRect part = view.drawn();
    const auto across = [&](double pixel) { return (2 * pixel / view.width - 1) * view.tanHalfWidth(); };
    const auto along = [&](double pixel) { return (1 - 2 * pixel / view.height) * view.tanHalfHeight; };
    const double left = across(static_cast<double>(part.x)), right = across(static_cast<double>(part.x + part.width));
    const double top = along(static_cast<double>(part.y)), bottom = along(static_cast<double>(part.y + part.height));
    inward_ = {view.right - left * view.forward, right * view.forward - view.right, view.up - bottom * view.forward,
               top * view.forward - view.up, view.forward};
}

bool Frustum::mayMeet(const Box& box) const {
    return mayMeetShadow(box, glm::dvec3(0), 0);
}

bool Frustum::mayMeetShadow(const Box& box, const glm::dvec3& away, double length) const {
    // The corner farthest inside decides, or where its shadow ends; rounding errors, relative to the terms of the sum,
    // must not exclude a box that touches.
    const glm::dvec3 low = box.min - eye_, high = box.max - eye_;
    for (const glm::dvec3& normal : inward_) {
        const glm::dvec3 terms = glm::max(normal * low, normal * high);
        const double further = std::max(glm::dot(normal, away) * length, 0.0);
        const double scale = std::abs(terms.x) + std::abs(terms.y) + std::abs(terms.z) + further;
        if (terms.x + terms.y + terms.z + further < -1e-9 * scale) return false;
    }
    return true;
}

GroundBounds::GroundBounds(const TileTree& tree) : tree_(tree) {
    const auto* root = tree.heights(TileId{});
    TERRAY_CHECK(root != nullptr && root->childrenKnown);
    const Ground ground = groundOf(root->record);
    const double range = ground.high - ground.low;
    // A tile's codes span less than the whole range, and its exponent is the smallest that fits: twice range / 65534 at
    // most; but edits may need larger steps.
    const double step = std::max({root->metresPerCode, range / 32767, tree.coarsestEditedStep()});
    // Half a step per level for the means' rounding, half for the finest samples', half to spare.
    margin_ = step * (1 + 0.5 * tree.finestHeightLevel());
    floor_ = ground.low - std::max(margin_, 0.02 * range);
}

Neighbourhood GroundBounds::ofRoot() const {
    Neighbourhood nine;
    nine[4] = groundOf(tree_.heights(TileId{})->record);
    return nine;
}

Neighbourhood GroundBounds::ofChild(const Neighbourhood& parent, const TileId& child, uint32_t deepest) const {
    Neighbourhood nine;
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            // The square lies in the parent's neighbour at floor((quadrant + d) / 2).
            const int column = (static_cast<int>(child.x & 1) + dx + 2) / 2;
            const int row = (static_cast<int>(child.y & 1) + dy + 2) / 2;
            Ground& ground = nine[3 * (dy + 1) + dx + 1];
            ground = parent[3 * row + column];
            const auto id = neighbour(child, dx, dy);
            if (!id || !ground.surface || child.level > deepest) continue;
            const auto* known = tree_.heights(*id);
            if (known == nullptr) continue;
            const Ground above = ground;
            ground = groundOf(known->record);
            ground.low = std::max(ground.low, above.low);
            ground.high = std::min(ground.high, above.high);
        }
    }
    return nine;
}

double GroundBounds::highestAround(const Neighbourhood& cell) const {
    double highest = cell[4].high;
    for (const Ground& ground : cell)
        if (ground.surface) highest = std::max(highest, ground.high);
    return highest + margin_;
}

double GroundBounds::highest(const Neighbourhood& cell, uint32_t levelsAbove) const {
    return levelsAbove <= 1 ? cell[4].high + margin_ : highestAround(cell);
}

double GroundBounds::top(const Neighbourhood& cell, uint32_t levelsAbove) const {
    return levelsAbove <= 1 ? cell[4].top + margin_ : highestAround(cell);
}

double GroundBounds::wallFoot(const Neighbourhood& cell) const {
    bool block = cell[4].hasHoles;
    double lowest = cell[4].low;
    for (const Ground& ground : cell) {
        block = block || !ground.surface;
        if (ground.surface) lowest = std::min(lowest, ground.low);
    }
    lowest -= margin_;
    return block ? std::min(lowest, floor_) : lowest;
}

}  // namespace terray
