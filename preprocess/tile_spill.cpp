#include "preprocess/tile_spill.h"

#include <algorithm>

#include "common/parallel.h"

namespace terray {

void TileSpill::add(const TileId& id, ByteView payload) {
    uint64_t offset = 0;
    {
        const std::scoped_lock lock(mutex_);
        offset = end_;
        end_ += payload.size();
        places_.push_back({hilbertId(id), offset, payload.size()});
    }
    // Outside the lock: each tile has its own place, so threads may write at once.
    file_.write(offset, payload);
}

void TileSpill::writeTo(PmtilesWriter& writer, const std::atomic<bool>& stop) {
    std::ranges::sort(places_, {}, &Place::hilbert);
    Bytes payload;
    for (const Place& place : places_) {
        throwIfStopped(stop);
        payload.resize(place.length);
        file_.read(place.offset, payload);
        writer.add(tileFromHilbert(place.hilbert).value(), payload);
    }
}

}  // namespace terray
