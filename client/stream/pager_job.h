#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/stream/host_cache.h"

namespace terray {

// What one request of the pager is made of. A job belongs to one thread at a time: the IO thread while it is read, a
// worker while it is decoded.

/// How often a tile is read before it counts as lost: bytes may be damaged on their way.
inline constexpr int kReads = 2;

/// One tile on its way from the source.
struct TilePart {
    TileKey key;
    std::optional<Bytes> payload;  ///< read, not yet decoded
    HeldTile tile;                 ///< once decoded, or held from the start
    bool fetched = false;          ///< this job reads it, and has reserved memory for it
    int reads = 0;
    uint64_t storedBytes = 0;  ///< as it was read last
    std::string trouble;       ///< what went wrong last
    [[nodiscard]] bool done() const { return tile.bytes > 0; }
    [[nodiscard]] bool lost() const { return !done() && !payload && reads >= kReads; }
    [[nodiscard]] bool toBeRead() const { return !done() && !payload && reads < kReads; }
};

/// A request that has been begun.
struct TileJob {
    TileKey key;
    /// What the request needs: the tile, and for imagery the ancestors that its mip chain is gathered from. Coarse to
    /// fine, so the tile itself is last. Those that were held are done from the start.
    std::vector<TilePart> parts;
    std::shared_ptr<const Bytes> imageryChain;
    std::string unreachable;  ///< why the source cannot answer for now; empty: it can

    /// The first part that cannot be had; nullptr when there is none.
    [[nodiscard]] const TilePart* lostPart() const;
    /// Decodes what has been read, and gathers a photo's chain once all is there. @return whether it is
    bool decode();
};

/// The tiles that a request needs, coarse to fine.
[[nodiscard]] std::vector<TileKey> needsOf(const TileKey& key);
/// For messages: "height tile 3/1/2".
[[nodiscard]] std::string describe(const TileKey& key);

}  // namespace terray
