#include "client/stream/host_cache.h"

#include <utility>

namespace terray {

uint64_t hostBytesOf(const TileKey& key) {
    if (key.layer == TileLayer::heights)
        return sizeof(HeightTile) + uint64_t{kHeightTileSide} * kHeightTileSide * sizeof(uint16_t);
    return sizeof(ImageryTile) + (key.id.level == 0 ? imageryChainBytes() : imageryMipBytes(0));
}

const HeldTile* HostCache::use(const TileKey& key) {
    const auto found = places_.find(key);
    if (found == places_.end()) return nullptr;
    touchPath(key);
    return &found->second->second;
}

void HostCache::insert(const TileKey& key, HeldTile tile) {
    if (const auto old = places_.find(key); old != places_.end()) {
        bytes_ -= old->second->second.bytes;
        tiles_.erase(old->second);
        places_.erase(old);
    }
    bytes_ += tile.bytes;
    tiles_.emplace_front(key, std::move(tile));
    places_[key] = tiles_.begin();
    touchPath(key);
}

uint64_t HostCache::shrinkTo(uint64_t bytes) {
    uint64_t gone = 0;
    for (; bytes_ > bytes; ++gone) {
        bytes_ -= tiles_.back().second.bytes;
        places_.erase(tiles_.back().first);
        tiles_.pop_back();
    }
    return gone;
}

void HostCache::touchPath(TileKey key) {
    for (;; key.id = key.id.parent()) {
        if (const auto found = places_.find(key); found != places_.end())
            tiles_.splice(tiles_.begin(), tiles_, found->second);
        if (key.id.level == 0) return;
    }
}

}  // namespace terray
