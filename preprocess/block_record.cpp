#include "preprocess/block_record.h"

#include <algorithm>

#include "common/pmtiles.h"

namespace terray {
namespace {

constexpr size_t kTileBytes = 20;
constexpr size_t kErrorBytes = 4;

void writeId(ByteWriter& out, const TileId& id) {
    out.write(hilbertId(id));
}

bool readId(ByteReader& in, TileId& id) {
    const auto found = tileFromHilbert(in.read<uint64_t>());
    if (!in.ok() || !found.ok()) return false;
    id = *found;
    return true;
}

}  // namespace

uint64_t BlockRecord::payloadBytes() const {
    uint64_t bytes = 0;
    for (const StoredTile& tile : tiles) bytes += tile.length;
    return bytes;
}

void BlockRecord::sortTiles() {
    std::ranges::sort(tiles, {}, [](const StoredTile& tile) { return hilbertId(tile.id); });
}

Bytes encodeBlockRecord(const BlockRecord& record) {
    ByteWriter out;
    out.write(static_cast<uint8_t>(record.pyramid));
    out.write(static_cast<uint8_t>(record.topRecord.exists));
    out.write(static_cast<uint8_t>(record.topRecord.hasHoles));
    out.write(static_cast<uint8_t>(record.bottom));
    writeId(out, record.top);
    out.write(record.topRecord.minHeight);
    out.write(record.topRecord.maxHeight);
    out.write(record.topRecord.error);
    out.write(record.holeSamples);
    out.write(record.minHeight);
    out.write(record.maxHeight);
    out.write(record.finestStep);
    out.write(static_cast<uint32_t>(record.levelErrors.size()));
    for (const float error : record.levelErrors) out.write(error);
    out.write(static_cast<uint32_t>(record.tiles.size()));
    for (const StoredTile& tile : record.tiles) {
        writeId(out, tile.id);
        out.write(tile.offset);
        out.write(tile.length);
    }
    return out.release();
}

Result<BlockRecord> decodeBlockRecord(ByteView bytes) {
    const Failure damaged{"the record of a block is damaged"};
    ByteReader in(bytes);
    BlockRecord record;
    const auto pyramid = in.read<uint8_t>();
    if (pyramid > static_cast<uint8_t>(Pyramid::imagery)) return damaged;
    record.pyramid = static_cast<Pyramid>(pyramid);
    record.topRecord.exists = in.read<uint8_t>() != 0;
    record.topRecord.hasHoles = in.read<uint8_t>() != 0;
    record.bottom = in.read<uint8_t>();
    if (!readId(in, record.top)) return damaged;
    record.topRecord.minHeight = in.read<float>();
    record.topRecord.maxHeight = in.read<float>();
    record.topRecord.error = in.read<float>();
    record.holeSamples = in.read<uint64_t>();
    record.minHeight = in.read<float>();
    record.maxHeight = in.read<float>();
    record.finestStep = in.read<double>();
    const auto errors = in.read<uint32_t>();
    if (!in.ok() || errors > in.remaining() / kErrorBytes) return damaged;
    for (uint32_t i = 0; i < errors; ++i) record.levelErrors.push_back(in.read<float>());
    const auto tiles = in.read<uint32_t>();
    if (!in.ok() || tiles > in.remaining() / kTileBytes) return damaged;
    record.tiles.resize(tiles);
    for (StoredTile& tile : record.tiles) {
        if (!readId(in, tile.id)) return damaged;
        tile.offset = in.read<uint64_t>();
        tile.length = in.read<uint32_t>();
    }
    if (!in.ok() || in.remaining() != 0) return damaged;
    return record;
}

}  // namespace terray
