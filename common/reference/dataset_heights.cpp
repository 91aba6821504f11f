#include "common/reference/dataset_heights.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/error.h"

namespace terray {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Calls use(tile) for each tile of the finest level whose core meets the rectangle.
template <class Use>
void forEachTile(const GridRect& rect, uint32_t level, Use use) {
    for (int64_t y = rect.y / kTileCore; y * kTileCore < rect.y + rect.height; ++y)
        for (int64_t x = rect.x / kTileCore; x * kTileCore < rect.x + rect.width; ++x)
            use(TileId{level, static_cast<uint32_t>(x), static_cast<uint32_t>(y)});
}

/// A number from -1/2 to 1/2 that belongs to a sample. Source: SplitMix64 (Steele, Lea, Flood 2014).
double partOf(int64_t x, int64_t y) {
    uint64_t z = static_cast<uint64_t>(x) * 0x9e3779b97f4a7c15ULL + static_cast<uint64_t>(y) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53 - 0.5;
}

[[noreturn]] void refuse(const TileId& id, const std::string& reason) {
    throw Error(ExitCode::dataset, "cannot read height tile " + toString(id) + " for the reference: " + reason +
                                       " (terray-preprocess verify lists all damaged tiles)");
}

}  // namespace

DatasetHeights::DatasetHeights(const DatasetMetadata& metadata, ReadPayload readPayload, Rounding rounding)
    : size_(metadata.samples),
      finestLevel_(metadata.tiling.finestLevel),
      quantum_(metadata.quantum),
      readPayload_(std::move(readPayload)),
      rounding_(rounding) {}

double DatasetHeights::upperBound(const GridRect& rect) const {
    double bound = -std::numeric_limits<double>::infinity();
    forEachTile(rect, finestLevel_, [&](const TileId& id) {
        const HeightRecord record = recordOf(id);
        if (!record.exists) return;
        // The record's bounds are rounded outwards, so their step is the tile's or a greater one.
        const double step = rounding_ == Rounding::undone
                                ? HeightEncoding::covering(record.minHeight, record.maxHeight, quantum_).metresPerCode()
                                : 0;
        bound = std::max(bound, record.maxHeight + step / 2);
    });
    return bound;
}

Grid<double> DatasetHeights::read(const GridRect& rect) const {
    Grid<double> heights({rect.width, rect.height}, kNone);
    forEachTile(rect, finestLevel_, [&](const TileId& id) {
        if (!recordOf(id).exists) return;
        const HeightTile stored = tile(id);
        const GridRect core = Tiling::coreSamples(id);
        const double undone = rounding_ == Rounding::undone ? stored.encoding.metresPerCode() : 0;
        const GridRect shared = intersection(rect, core);
        for (int64_t y = shared.y; y < shared.y + shared.height; ++y)
            for (int64_t x = shared.x; x < shared.x + shared.width; ++x) {
                const uint16_t code = stored.codes.at(x - core.x + kHeightApron, y - core.y + kHeightApron);
                if (code == kNoSurface) continue;
                const double height = stored.encoding.height(code);
                if (height > stored.record.maxHeight) refuse(id, "a sample is higher than the tile's record says");
                heights.at(x - rect.x, y - rect.y) = height + undone * partOf(x, y);
            }
    });
    return heights;
}

HeightRecord DatasetHeights::recordOf(const TileId& id) const {
    if (id.level == 0) {
        std::call_once(rootRead_, [&] { root_ = tile(id).record; });
        return root_;
    }
    const TileId parent = id.parent();
    {
        const std::scoped_lock lock(mutex_);
        if (const auto known = children_.find(parent); known != children_.end()) return known->second[id.quadrant()];
    }
    std::array<HeightRecord, 4> children{};
    if (recordOf(parent).exists) children = tile(parent).children;
    const std::scoped_lock lock(mutex_);
    return children_.emplace(parent, children).first->second[id.quadrant()];
}

HeightTile DatasetHeights::tile(const TileId& id) const {
    const Result<Bytes> payload = readPayload_(id);
    if (!payload) refuse(id, payload.failure().message);
    Result<HeightTile> decoded = decodeHeightTile(*payload, id);
    if (!decoded) refuse(id, decoded.failure().message);
    return std::move(decoded).value();
}

}  // namespace terray
