#include "common/edited_ground.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/check.h"

namespace terray {
namespace {

/// Squares of this many samples are not halved further.
constexpr double kLeastSquare = 16;

HeightSpan hull(const HeightSpan& a, const HeightSpan& b) {
    return {std::min(a.lowest, b.lowest), std::max(a.highest, b.highest)};
}

}  // namespace

struct EditedGround::Bounds {
    HeightSpan stored;     ///< of the record
    HeightSpan finest;     ///< of finest samples beneath
    double spacing = 1;    ///< metres between the tile's samples
    double apart = 0;      ///< metres from a core sample's centre to finest ones beneath, at most
    HeightSpan heights{};  ///< result
    double variation = 0;  ///< result
};

EditedGround::EditedGround(const Tiling& tiling, double quantum, EditList edits)
    : tiling_(tiling), quantum_(quantum), edits_(std::move(edits)) {
    TERRAY_CHECK(valid(edits_));
}

EditList EditedGround::near(const TileId& id) const {
    return editsNear(edits_, widened(tiling_.bounds(id), kHeightApron * tiling_.spacing(id.level)));
}

void EditedGround::collect(const GroundRect& square, std::span<const TerrainEdit> edits, Bounds& bounds) const {
    const GroundRect region = widened(square, kHeightApron * bounds.spacing);
    const EditList near = editsNear(edits, region);
    const double side = square.east - square.west;
    const bool apart = std::ranges::any_of(near, [side](const TerrainEdit& edit) { return reachOf(edit) < side; });
    if (near.size() > 1 && apart && side > kLeastSquare * bounds.spacing) {
        const double x = square.west + side / 2, y = square.south + side / 2;
        collect({square.west, square.south, x, y}, near, bounds);
        collect({x, square.south, square.east, y}, near, bounds);
        collect({square.west, y, x, square.north}, near, bounds);
        collect({x, y, square.east, square.north}, near, bounds);
        return;
    }
    bounds.heights = hull(bounds.heights, editBounds(near, region, bounds.stored, 0).heights);
    bounds.variation = std::max(bounds.variation, editBounds(near, region, bounds.finest, bounds.apart).variation);
}

std::optional<EditedGround::Bounds> EditedGround::boundsOf(const TileId& id, const HeightRecord& stored) const {
    if (!stored.exists) return {};
    const EditList near = this->near(id);
    if (near.empty()) return {};
    Bounds bounds{
        .stored = {stored.minHeight, stored.maxHeight},
        .finest = {double{stored.minHeight} - stored.error, double{stored.maxHeight} + stored.error},
        .spacing = tiling_.spacing(id.level),
        .apart = (tiling_.spacing(id.level) - tiling_.finestSpacing) / std::numbers::sqrt2,
        .heights = {stored.minHeight, stored.maxHeight},
    };
    collect(tiling_.bounds(id), near, bounds);
    return bounds;
}

HeightRecord EditedGround::recordFrom(const Bounds& bounds, const HeightRecord& stored, double leastStep) const {
    const HeightSpan& heights = bounds.heights;
    const double covering = HeightEncoding::covering(heights.lowest, heights.highest, quantum_).metresPerCode();
    const double half = std::max(covering, leastStep) / 2;
    return {.exists = true,
            .hasHoles = stored.hasHoles,
            .minHeight = floatAtMost(heights.lowest - half),
            .maxHeight = floatAtLeast(heights.highest + half),
            .error = floatAtLeast(stored.error + bounds.variation + half)};
}

std::optional<HeightRecord> EditedGround::record(const TileId& id, const HeightRecord& stored, double leastStep) const {
    const auto bounds = boundsOf(id, stored);
    if (!bounds) return {};
    return recordFrom(*bounds, stored, leastStep);
}

double EditedGround::stepOf(const HeightRecord& edited, double leastStep) const {
    return std::max(leastStep, HeightEncoding::covering(edited.minHeight, edited.maxHeight, quantum_).metresPerCode());
}

std::optional<EditedTile> EditedGround::describe(const HeightTile& tile) const {
    const auto bounds = boundsOf(tile.id, tile.record);
    if (!bounds) return {};
    const double step = tile.encoding.metresPerCode();
    const auto codeOf = [&](double height) {
        return std::round(height / step) - static_cast<double>(tile.encoding.offset);
    };
    const bool fits = codeOf(bounds->heights.lowest) >= 1 && codeOf(bounds->heights.highest) <= 65535;
    return EditedTile{
        .edits = near(tile.id),
        .encoding =
            fits ? tile.encoding : HeightEncoding::covering(bounds->heights.lowest, bounds->heights.highest, quantum_),
        .record = recordFrom(*bounds, tile.record, step),
        .corner = {tiling_.west, tiling_.north},
        .spacing = tiling_.spacing(tile.id.level),
    };
}

}  // namespace terray
