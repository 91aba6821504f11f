#include "client/render/slot_table.h"

#include <algorithm>
#include <iterator>

namespace terray {

SlotTable::SlotTable(uint32_t capacity) : capacity_(capacity) {
    // Taken from the back, so slot 0 goes first.
    for (uint32_t slot = capacity; slot-- > 0;) free_.push_back(slot);
}

std::optional<uint32_t> SlotTable::find(const TileId& id) const {
    const auto found = where_.find(id);
    if (found == where_.end()) return {};
    return found->second->slot;
}

std::optional<SlotTable::Place> SlotTable::place(const TileId& id) {
    if (touch(id)) return Place{.slot = order_.front().slot, .evicted = {}};
    Place result;
    if (!free_.empty()) {
        result.slot = free_.back();
        free_.pop_back();
        order_.push_front({id, result.slot});
    } else {
        const auto victim = std::find_if(order_.rbegin(), order_.rend(),
                                         [&](const Entry& entry) { return entry.pinnedFrame != frame_; });
        if (victim == order_.rend()) return {};
        result = {victim->slot, victim->id};
        where_.erase(victim->id);
        order_.splice(order_.begin(), order_, std::prev(victim.base()));
        order_.front() = {id, result.slot};
    }
    where_.emplace(id, order_.begin());
    return result;
}

bool SlotTable::pin(const TileId& id) {
    if (!touch(id)) return false;
    order_.front().pinnedFrame = frame_;
    return true;
}

bool SlotTable::touch(const TileId& id) {
    const auto found = where_.find(id);
    if (found == where_.end()) return false;
    order_.splice(order_.begin(), order_, found->second);
    return true;
}

bool SlotTable::remove(const TileId& id) {
    const auto found = where_.find(id);
    if (found == where_.end()) return false;
    free_.push_back(found->second->slot);
    order_.erase(found->second);
    where_.erase(found);
    return true;
}

}  // namespace terray
