#include "client/overlay/ground_heights.h"

#include <cmath>
#include <string>
#include <utility>

#include "common/error.h"

namespace terray {
namespace {

bool holds(const GroundRect& bounds, glm::dvec2 place) {
    return place.x >= bounds.west && place.x < bounds.east && place.y > bounds.south && place.y <= bounds.north;
}

}  // namespace

HeightTile GroundHeights::read(const TileId& id) const {
    const auto refuse = [&id](const Failure& failure) {
        return Error(ExitCode::dataset, "cannot read height tile " + toString(id) + ": " + failure.message +
                                            "; terray-preprocess verify tells what is damaged");
    };
    const auto payload = source_.read(TileLayer::heights, id);
    if (!payload) throw refuse(payload.failure());
    auto tile = decodeHeightTile(*payload, id);
    if (!tile) throw refuse(tile.failure());
    return std::move(*tile);
}

bool GroundHeights::find(glm::dvec2 place) {
    const Tiling& tiling = source_.metadata().tiling;
    if (tile_ && tile_->id.level == tiling.finestLevel && holds(tiling.bounds(tile_->id), place)) return true;
    tile_.reset();
    if (!holds(tiling.bounds({}), place)) return false;
    tile_ = read({});
    while (tile_->id.level < tiling.finestLevel) {
        uint32_t quadrant = 0;
        while (quadrant < 4 && !holds(tiling.bounds(tile_->id.child(quadrant)), place)) ++quadrant;
        if (quadrant == 4 || !tile_->children[quadrant].exists) return false;
        tile_ = read(tile_->id.child(quadrant));
    }
    return true;
}

std::optional<double> GroundHeights::at(glm::dvec2 place) {
    if (!find(place)) return {};
    const Tiling& tiling = source_.metadata().tiling;
    const GroundRect bounds = tiling.bounds(tile_->id);
    const double spacing = tiling.spacing(tile_->id.level);
    const auto cell = [&](double metres) {
        return std::min(static_cast<int64_t>(metres / spacing), int64_t{kTileCore - 1});
    };
    const int64_t column = cell(place.x - bounds.west), row = cell(bounds.north - place.y);
    const uint16_t code = tile_->codes.at(column + kHeightApron, row + kHeightApron);
    if (code == kNoSurface) return {};
    const glm::dvec2 centre(bounds.west + (static_cast<double>(column) + 0.5) * spacing,
                            bounds.north - (static_cast<double>(row) + 0.5) * spacing);
    return editedHeight(tile_->encoding.height(code), centre, edits_);
}

}  // namespace terray
