#include "client/bench/requantised_source.h"

#include <algorithm>

#include "common/check.h"

namespace terray {
namespace {

/// The same heights in steps of the quantum, as few as cover them; children are left as they were.
HeightTile inSteps(const HeightTile& stored, double quantum) {
    HeightTile tile = stored;
    tile.encoding = HeightEncoding::covering(stored.record.minHeight, stored.record.maxHeight, quantum);
    for (uint16_t& code : tile.codes.cells())
        if (code != kNoSurface) code = tile.encoding.code(stored.encoding.height(code));
    const double error = stored.record.error + tile.encoding.metresPerCode() / 2;
    tile.record = measureRecord(tile.codes, tile.encoding, floatAtLeast(error));
    return tile;
}

}  // namespace

RequantisedSource::RequantisedSource(const TileSource& source, double quantum)
    : source_(source), metadata_(source.metadata()) {
    TERRAY_CHECK_OP(quantum, >=, metadata_.quantum);
    metadata_.quantum = quantum;
    const double half = HeightEncoding::covering(metadata_.minHeight, metadata_.maxHeight, quantum).metresPerCode() / 2;
    metadata_.minHeight -= half;
    metadata_.maxHeight += half;
    for (double& error : metadata_.levelErrors) error += half;
    metadata_.errorBound += half;
}

Result<Bytes> RequantisedSource::read(TileLayer layer, const TileId& id) const {
    if (layer != TileLayer::heights) return source_.read(layer, id);
    Result<HeightTile> tile = requantised(id);
    if (!tile) return tile.failure();
    for (uint32_t quadrant = 0; quadrant < 4; ++quadrant) {
        HeightRecord& child = tile->children[quadrant];
        if (!child.exists) continue;
        const Result<HeightRecord> record = recordOf(id.child(quadrant));
        if (!record) return record.failure();
        child = *record;
    }
    return encodeHeightTile(*tile);
}

std::string RequantisedSource::contentHash() const {
    return source_.contentHash() + " in steps of " + Json(metadata_.quantum).dump();
}

Result<HeightTile> RequantisedSource::requantised(const TileId& id) const {
    const Result<Bytes> payload = source_.read(TileLayer::heights, id);
    if (!payload) return payload.failure();
    const Result<HeightTile> stored = decodeHeightTile(*payload, id);
    if (!stored) return stored.failure();
    return inSteps(*stored, metadata_.quantum);
}

Result<HeightRecord> RequantisedSource::recordOf(const TileId& id) const {
    {
        const std::scoped_lock lock(mutex_);
        if (const auto known = records_.find(id); known != records_.end()) return known->second;
    }
    const Result<HeightTile> tile = requantised(id);
    if (!tile) return tile.failure();
    const std::scoped_lock lock(mutex_);
    return records_.emplace(id, tile->record).first->second;
}

}  // namespace terray
