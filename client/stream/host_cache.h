#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <unordered_map>

#include "client/stream/dataset_source.h"

namespace terray {

/// A tile of one of the two layers.
struct TileKey {
    TileLayer layer = TileLayer::heights;
    TileId id;
    bool operator==(const TileKey&) const = default;
};

struct TileKeyHash {
    size_t operator()(const TileKey& key) const noexcept {
        return std::hash<TileId>()(key.id) * 2 + static_cast<size_t>(key.layer);
    }
};

/// A decoded tile: one of the two pointers is set.
struct HeldTile {
    std::shared_ptr<const HeightTile> heights;
    std::shared_ptr<const ImageryTile> imagery;
    uint64_t bytes = 0;
};

/// Main memory that a decoded tile takes, known before it has arrived.
[[nodiscard]] uint64_t hostBytesOf(const TileKey& key);

/// Decoded tiles, the least recently used going first. Using a tile uses its held ancestors after it, so an ancestor is
/// always newer than what lies beneath it, and no tile goes before its descendants have gone. One thread, or a lock
/// outside.
class HostCache {
  public:
    /// The tile, now the newest but for its ancestors; nullptr when it is not held.
    [[nodiscard]] const HeldTile* use(const TileKey& key);
    [[nodiscard]] bool holds(const TileKey& key) const { return places_.contains(key); }
    /// Takes a tile in, replacing one of the same key.
    void insert(const TileKey& key, HeldTile tile);
    /// Lets the oldest go until no more than `bytes` are held. @return how many went
    uint64_t shrinkTo(uint64_t bytes);
    [[nodiscard]] uint64_t bytes() const { return bytes_; }

  private:
    using Tiles = std::list<std::pair<TileKey, HeldTile>>;
    void touchPath(TileKey key);

    Tiles tiles_;  ///< newest first
    std::unordered_map<TileKey, Tiles::iterator, TileKeyHash> places_;
    uint64_t bytes_ = 0;
};

}  // namespace terray
