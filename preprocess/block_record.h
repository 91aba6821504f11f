#pragma once

#include <cstdint>
#include <vector>

#include "common/bytes.h"
#include "common/height_tile.h"
#include "common/result.h"
#include "common/tile_id.h"

namespace terray {

/// The two pyramids of a dataset.
enum class Pyramid : uint8_t { heights = 0, imagery = 1 };

/// A finished tile and where it lies in the spill.
struct StoredTile {
    TileId id;
    uint64_t offset = 0;
    uint32_t length = 0;

    bool operator==(const StoredTile&) const = default;
};

/// All that a finished block leaves beside its bytes. The journal keeps it, and the rest of the build takes it from
/// here alone, so that a block of an earlier run counts exactly as one of this run does.
struct BlockRecord {
    Pyramid pyramid = Pyramid::heights;
    uint32_t bottom = 0;            ///< of the block's stage, which says which stage it is
    TileId top;                     ///< the block's own id
    std::vector<StoredTile> tiles;  ///< by level, then in Hilbert order: see sortTiles()
    HeightRecord topRecord;         ///< of the block's top tile; imagery: `exists` alone
    uint64_t holeSamples = 0;       ///< finest samples of the source without surface, first stage only
    float minHeight = 0;            ///< metres, over all tiles; 0 without any
    float maxHeight = 0;
    std::vector<float> levelErrors;  ///< metres, greatest of each level, from the top level downwards
    double finestStep = 0;           ///< metres, the widest code step of the source's own level; first stage only

    bool operator==(const BlockRecord&) const = default;

    [[nodiscard]] uint64_t payloadBytes() const;
    /// Puts the tiles into the order of their Hilbert ids.
    void sortTiles();
};

/// The content of a journal entry, 20 bytes a tile.
[[nodiscard]] Bytes encodeBlockRecord(const BlockRecord& record);
/// Checks sizes and ids.
[[nodiscard]] Result<BlockRecord> decodeBlockRecord(ByteView bytes);

}  // namespace terray
