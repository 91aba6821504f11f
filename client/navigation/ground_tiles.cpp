#include "client/navigation/ground_tiles.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/error.h"

namespace terray {
namespace {

bool holds(const GroundRect& bounds, glm::dvec2 place) {
    return place.x >= bounds.west && place.x < bounds.east && place.y > bounds.south && place.y <= bounds.north;
}

/// A coordinate in samples, and its cell, kept within core and apron.
int64_t cellOf(double samples) {
    const double cell = std::clamp(std::floor(samples), -1.0 * kHeightApron, 1.0 * (kTileCore + kHeightApron - 1));
    return static_cast<int64_t>(cell);
}

}  // namespace

GroundTiles::GroundTiles(const TileSource& source, Options options)
    : source_(source),
      edits_(std::move(options.edits)),
      mostTiles_(options.mostTiles),
      finestLevel_(std::min(options.finestLevel.value_or(kMaxTileLevel), source.metadata().tiling.finestLevel)) {
    Tile root = read({});
    if (!root)
        throw Error(ExitCode::dataset, "cannot read height tile 0/0/0; terray-preprocess verify tells what is damaged");
    keep({}, std::move(root));
    thread_ = std::thread([this] { work(); });
}

GroundTiles::~GroundTiles() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void GroundTiles::work() {
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [this] { return ending_ || !wanted_.empty(); });
        if (ending_) return;
        const TileId finest = wanted_.front();
        const std::optional<TileId> missing = wayTo(finest).missing;
        if (missing) {
            lock.unlock();
            Tile tile = read(*missing);
            lock.lock();
            keep(*missing, std::move(tile));
        } else {
            std::erase(wanted_, finest);
            changed_.notify_all();
        }
    }
}

GroundTiles::Tile GroundTiles::read(const TileId& id) const {
    const auto payload = source_.read(TileLayer::heights, id);
    if (!payload) return {};
    auto tile = decodeHeightTile(*payload, id);
    return tile ? std::make_shared<const HeightTile>(std::move(*tile)) : Tile();
}

void GroundTiles::keep(const TileId& id, Tile tile) {
    recent_.push_front({id, std::move(tile)});
    known_[id] = recent_.begin();
    if (recent_.size() <= mostTiles_) return;
    // The root says where there is ground at all, so it stays.
    if (recent_.back().id == TileId{}) recent_.splice(recent_.begin(), recent_, std::prev(recent_.end()));
    known_.erase(recent_.back().id);
    recent_.pop_back();
}

TileId GroundTiles::finestOver(glm::dvec2 place) const {
    const Tiling& tiling = source_.metadata().tiling;
    const double side = tiling.tileSide(finestLevel_), last = std::ldexp(1.0, static_cast<int>(finestLevel_)) - 1;
    const auto index = [&](double metres) {
        return static_cast<uint32_t>(std::clamp(std::floor(metres / side), 0.0, last));
    };
    return {finestLevel_, index(place.x - tiling.west), index(tiling.north - place.y)};
}

GroundTiles::Way GroundTiles::wayTo(const TileId& finest) {
    Way way;
    for (uint32_t level = 0; level <= finest.level; ++level) {
        const TileId id = finest.ancestor(finest.level - level);
        if (way.deepest && !way.deepest->children[id.quadrant()].exists) return {};
        const auto entry = known_.find(id);
        if (entry == known_.end()) {
            way.missing = id;
            return way;
        }
        recent_.splice(recent_.begin(), recent_, entry->second);
        if (!entry->second->tile) return way;
        way.deepest = entry->second->tile;
    }
    return way;
}

std::optional<double> GroundTiles::heightIn(const HeightTile& tile, glm::dvec2 place) const {
    const Tiling& tiling = source_.metadata().tiling;
    const GroundRect bounds = tiling.bounds(tile.id);
    const double spacing = tiling.spacing(tile.id.level);
    const auto sample = [&](int64_t column, int64_t row) -> std::optional<double> {
        const uint16_t code = tile.codes.at(column + kHeightApron, row + kHeightApron);
        if (code == kNoSurface) return {};
        const glm::dvec2 centre(bounds.west + (static_cast<double>(column) + 0.5) * spacing,
                                bounds.north - (static_cast<double>(row) + 0.5) * spacing);
        return editedHeight(tile.encoding.height(code), centre, edits_);
    };
    const double x = (place.x - bounds.west) / spacing, y = (bounds.north - place.y) / spacing;
    if (columns_) return sample(cellOf(x), cellOf(y));

    const int64_t column = std::min(cellOf(x - 0.5), int64_t{kTileCore}),
                  row = std::min(cellOf(y - 0.5), int64_t{kTileCore});
    const double right = x - 0.5 - static_cast<double>(column), down = y - 0.5 - static_cast<double>(row);
    const std::optional<double> corners[4] = {sample(column, row), sample(column + 1, row), sample(column, row + 1),
                                              sample(column + 1, row + 1)};
    if (std::all_of(std::begin(corners), std::end(corners), [](const auto& corner) { return corner.has_value(); }))
        return std::lerp(std::lerp(*corners[0], *corners[1], right), std::lerp(*corners[2], *corners[3], right), down);
    return std::max({corners[0], corners[1], corners[2], corners[3]});  // an empty one is less than any height
}

std::optional<GroundHeight> GroundTiles::under(glm::dvec2 place) {
    if (!holds(source_.metadata().tiling.bounds({}), place)) return {};
    Way way;
    {
        const std::lock_guard lock(mutex_);
        const TileId finest = finestOver(place);
        way = wayTo(finest);
        if (way.missing && std::find(wanted_.begin(), wanted_.end(), finest) == wanted_.end()) {
            wanted_.push_front(finest);
            if (wanted_.size() > kMostWanted) wanted_.pop_back();
            changed_.notify_all();
        }
    }
    if (!way.deepest) return {};
    const std::optional<double> height = heightIn(*way.deepest, place);
    if (!height) return {};
    const bool finest = way.deepest->id.level == source_.metadata().tiling.finestLevel;
    return GroundHeight{*height, finest ? 0 : double{way.deepest->record.error}};
}

bool GroundTiles::learning() {
    const std::lock_guard lock(mutex_);
    return !wanted_.empty();
}

void GroundTiles::waitUntilSettled() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return wanted_.empty(); });
}

}  // namespace terray
