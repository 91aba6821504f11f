#include "client/stream/tile_tree.h"

#include <algorithm>
#include <unordered_set>
#include <utility>

#include "common/check.h"

namespace terray {
namespace {

/// Keeps the resident tiles, all above them, and the children of all these.
template <class Tile>
void keepAroundResident(std::unordered_map<TileId, Tile>& tiles) {
    std::unordered_set<TileId> inUse;
    for (const auto& [id, tile] : tiles) {
        if (!tile.resident) continue;
        TileId above = id;
        while (inUse.insert(above).second && above.level > 0) above = above.parent();
    }
    std::erase_if(tiles, [&inUse](const auto& entry) {
        const TileId& id = entry.first;
        return !inUse.contains(id) && id.level > 0 && !inUse.contains(id.parent());
    });
    for (auto& [id, tile] : tiles)
        if (!inUse.contains(id)) tile.childrenKnown = false;
}

}  // namespace

TileTree::TileTree(const Tiling& tiling, uint32_t finestHeightLevel, std::optional<uint32_t> finestImageryLevel)
    : tiling_(tiling), finestHeightLevel_(finestHeightLevel), finestImageryLevel_(finestImageryLevel) {
    TERRAY_CHECK_OP(finestHeightLevel, <=, kMaxTileLevel);
    TERRAY_CHECK_OP(finestImageryLevel.value_or(0), <=, kMaxTileLevel);
}

void TileTree::learn(const HeightTile& tile) {
    TERRAY_CHECK_OP(tile.id.level, <=, finestHeightLevel_);
    Heights& own = heights_[tile.id];
    describe(tile.id, own, {tile.record, tile.encoding.metresPerCode()});
    own.childrenKnown = true;
    if (tile.id.level == finestHeightLevel_) return;
    for (uint32_t quadrant = 0; quadrant < 4; ++quadrant) {
        const TileId child = tile.id.child(quadrant);
        const auto [place, isNew] = heights_.try_emplace(child);
        if (isNew) describe(child, place->second, {tile.children[quadrant]});
    }
}

void TileTree::describe(const TileId& id, Heights& tile, const Stored& stored) {
    tile.record = stored.record;
    tile.metresPerCode = stored.metresPerCode;
    if (!edits_) return;
    const auto edited = edits_->record(id, stored.record, stored.metresPerCode);
    if (!edited) return;
    tile.record = *edited;
    const double step = edits_->stepOf(*edited, stored.metresPerCode);
    if (stored.metresPerCode > 0) tile.metresPerCode = step;
    coarsestEditedStep_ = std::max(coarsestEditedStep_, step);
    stored_.insert_or_assign(id, stored);
}

void TileTree::setEdits(std::shared_ptr<const EditedGround> edits) {
    edits_ = std::move(edits);
    coarsestEditedStep_ = 0;
    const auto before = std::exchange(stored_, {});
    for (auto& [id, tile] : heights_) {
        const auto edited = before.find(id);
        describe(id, tile, edited != before.end() ? edited->second : Stored{tile.record, tile.metresPerCode});
    }
}

void TileTree::learn(const ImageryTile& tile) {
    TERRAY_CHECK(finestImageryLevel_.has_value());
    TERRAY_CHECK_OP(tile.id.level, <=, *finestImageryLevel_);
    Imagery& own = imagery_[tile.id];
    own.exists = true;
    own.childrenKnown = true;
    if (tile.id.level == *finestImageryLevel_) return;
    for (uint32_t quadrant = 0; quadrant < 4; ++quadrant)
        imagery_.try_emplace(tile.id.child(quadrant), Imagery{.exists = tile.childExists[quadrant]});
}

void TileTree::setHeightsResident(const TileId& id, bool resident) {
    const auto found = heights_.find(id);
    TERRAY_CHECK(found != heights_.end() && found->second.childrenKnown);
    found->second.resident = resident;
}

void TileTree::setImageryResident(const TileId& id, bool resident) {
    const auto found = imagery_.find(id);
    TERRAY_CHECK(found != imagery_.end() && found->second.childrenKnown);
    found->second.resident = resident;
}

void TileTree::forgetBeyond(size_t most) {
    if (knownTiles() <= std::max(most, 2 * keptLast_)) return;
    keepAroundResident(heights_);
    keepAroundResident(imagery_);
    std::erase_if(stored_, [this](const auto& entry) { return !heights_.contains(entry.first); });
    keptLast_ = knownTiles();
}

const TileTree::Heights* TileTree::heights(const TileId& id) const {
    const auto found = heights_.find(id);
    return found == heights_.end() ? nullptr : &found->second;
}

const TileTree::Imagery* TileTree::imagery(const TileId& id) const {
    const auto found = imagery_.find(id);
    return found == imagery_.end() ? nullptr : &found->second;
}

}  // namespace terray
