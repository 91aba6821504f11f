// The directories of pmtiles.h: columns of varints, ids as differences (specification v3, section 4).
#include <limits>

#include "common/check.h"
#include "common/pmtiles.h"

namespace terray {
namespace {

/// Where the entry after this one may begin, at the earliest; at most 2^64 - 1.
uint64_t endOf(const PmtilesEntry& entry) {
    const uint64_t run = entry.runLength == 0 ? 1 : entry.runLength;
    const uint64_t room = std::numeric_limits<uint64_t>::max() - entry.tileId;
    return entry.tileId + (run < room ? run : room);
}

/// A varint that must fit 32 bits, as lengths and runs.
std::optional<uint32_t> readShort(ByteReader& in) {
    const uint64_t value = in.readVarint();
    if (!in.ok() || value > std::numeric_limits<uint32_t>::max()) return {};
    return static_cast<uint32_t>(value);
}

}  // namespace

Bytes encodePmtilesDirectory(const std::vector<PmtilesEntry>& entries) {
    ByteWriter out;
    out.writeVarint(entries.size());
    uint64_t previousId = 0;
    for (const PmtilesEntry& entry : entries) {
        TERRAY_CHECK_OP(entry.tileId, >=, previousId);
        out.writeVarint(entry.tileId - previousId);
        previousId = entry.tileId;
    }
    for (const PmtilesEntry& entry : entries) out.writeVarint(entry.runLength);
    for (const PmtilesEntry& entry : entries) out.writeVarint(entry.length);
    // Offsets: 0 says "right after the previous entry's bytes", anything else is the offset plus one.
    const PmtilesEntry* previous = nullptr;
    for (const PmtilesEntry& entry : entries) {
        const bool follows = previous != nullptr && entry.offset == previous->offset + previous->length;
        out.writeVarint(follows ? 0 : entry.offset + 1);
        previous = &entry;
    }
    return out.release();
}

Result<std::vector<PmtilesEntry>> decodePmtilesDirectory(ByteView bytes) {
    const Failure cutShort{"PMTiles directory: cut short"};
    ByteReader in(bytes);
    const uint64_t count = in.readVarint();
    constexpr uint64_t kLeastEntryBytes = 4;  // four varints
    if (!in.ok() || count > in.remaining() / kLeastEntryBytes) return cutShort;
    if (count == 0) return Failure{"PMTiles directory: empty"};

    std::vector<PmtilesEntry> entries(count);
    uint64_t id = 0;
    for (PmtilesEntry& entry : entries) {
        const uint64_t step = in.readVarint();
        if (step > std::numeric_limits<uint64_t>::max() - id) return Failure{"PMTiles directory: a tile id overflows"};
        entry.tileId = id += step;
    }
    for (PmtilesEntry& entry : entries) {
        const auto runLength = readShort(in);
        if (!runLength) return Failure{"PMTiles directory: a run is cut short or over 32 bits"};
        entry.runLength = *runLength;
    }
    for (PmtilesEntry& entry : entries) {
        const auto length = readShort(in);
        if (!length || *length == 0) return Failure{"PMTiles directory: a length is 0, cut short or over 32 bits"};
        entry.length = *length;
    }
    const PmtilesEntry* previous = nullptr;
    for (PmtilesEntry& entry : entries) {
        const uint64_t field = in.readVarint();
        if (field == 0 && previous == nullptr) return Failure{"PMTiles directory: the first entry has no offset"};
        entry.offset = field == 0 ? previous->offset + previous->length : field - 1;
        if (entry.offset > std::numeric_limits<uint64_t>::max() - entry.length)
            return Failure{"PMTiles directory: an offset overflows"};
        if (previous != nullptr && entry.tileId < endOf(*previous))
            return Failure{"PMTiles directory: tile ids do not ascend"};
        previous = &entry;
    }
    if (!in.ok()) return cutShort;
    if (in.remaining() != 0) return Failure{"PMTiles directory: bytes after the last entry"};
    return entries;
}

}  // namespace terray
