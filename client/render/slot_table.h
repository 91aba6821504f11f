#pragma once

#include <cstdint>
#include <list>
#include <optional>
#include <unordered_map>
#include <vector>

#include "common/tile_id.h"

namespace terray {

/// Which tile lies in which of a fixed number of slots; the least recently used one makes room. Any thread, one at a
/// time.
class SlotTable {
  public:
    /// @param capacity  slots, numbered from 0
    explicit SlotTable(uint32_t capacity);

    [[nodiscard]] uint32_t capacity() const { return capacity_; }
    [[nodiscard]] size_t size() const { return where_.size(); }
    /// The tile's slot, if it has one.
    [[nodiscard]] std::optional<uint32_t> find(const TileId& id) const;

    struct Place {
        uint32_t slot = 0;
        std::optional<TileId> evicted;  ///< who had to go
    };
    /// A slot for a tile: its own if it has one, else a free one, else that of the least recently used tile that is not
    /// pinned; nothing when all are pinned. The tile is then the most recently used one.
    std::optional<Place> place(const TileId& id);

    /// Nothing is pinned any more.
    void unpinAll() { ++frame_; }
    /// Most recently used, and not evictable until unpinAll(). @return whether the tile has a slot
    bool pin(const TileId& id);
    /// Most recently used. @return whether the tile has a slot
    bool touch(const TileId& id);
    /// Frees a tile's slot, pinned or not. @return whether it had one
    bool remove(const TileId& id);

  private:
    struct Entry {
        TileId id;
        uint32_t slot = 0;
        uint64_t pinnedFrame = 0;
    };
    uint32_t capacity_;
    uint64_t frame_ = 1;
    std::vector<uint32_t> free_;
    std::list<Entry> order_;  ///< most recently used first
    std::unordered_map<TileId, std::list<Entry>::iterator> where_;
};

}  // namespace terray
