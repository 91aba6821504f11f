#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "common/check.h"
#include "common/pmtiles.h"
#include "tests/fuzz/allocation_limit.h"
#include "tests/fuzz/targets.h"

namespace terray::fuzz {
namespace {

constexpr size_t kMostTiles = 256;  // asked for; a run of a few bytes may stand for thousands of millions

class MemorySource final : public ByteSource {
  public:
    explicit MemorySource(ByteView bytes) : bytes_(bytes) {}
    Result<Bytes> read(uint64_t offset, uint64_t length) const override {
        // The reader has checked both against size().
        TERRAY_CHECK_OP(offset, <=, bytes_.size());
        TERRAY_CHECK_OP(length, <=, bytes_.size() - offset);
        const ByteView part = bytes_.subspan(offset, length);
        return Bytes(part.begin(), part.end());
    }
    uint64_t size() const override { return bytes_.size(); }
    std::string name() const override { return "memory"; }

  private:
    ByteView bytes_;
};

/// The limit follows from the reader's own: a directory or metadata unpacks to at most 64 MiB, and its smallest entry
/// of 4 bytes becomes 24. While one is unpacked its bytes are there three times (a growing array) and its entries once,
/// beside those of the directories above it and of the cache, which holds 2^20 entries and one more leaf.
size_t limitFor(ByteView bytes) {
    constexpr size_t kMaxInternalBytes = size_t{64} << 20;
    constexpr size_t kGzipFactor = 1032;  // deflate's best: 258 bytes in 2 bits
    constexpr size_t kEntryFactor = sizeof(PmtilesEntry) / 4;
    constexpr size_t kDirectories = 6;  // the root, three leaves on the way, the cache's greatest, the one being read
    constexpr size_t kCachedBytes = (size_t{1} << 20) * sizeof(PmtilesEntry);
    constexpr size_t kLeafBytes = 256;  // of the cache's book-keeping; leaves begin at different bytes
    constexpr size_t kSmallThings = size_t{64} << 10;
    const auto header = decodePmtilesHeader(bytes);
    const bool isPacked = header.ok() && header->internalCompression == PmtilesCompression::gzip;
    const size_t unpacked = std::min(kMaxInternalBytes, bytes.size() * (isPacked ? kGzipFactor : 1));
    return kCachedBytes + (kDirectories * kEntryFactor + 3) * unpacked + (kLeafBytes + 4) * bytes.size() + kSmallThings;
}

struct SeenTile {
    TileId id;
    ByteRange range;
};
struct Walk {
    std::vector<SeenTile> tiles;
    bool isWhole = false;  ///< all tiles, and no fault among them
};

Walk walk(const PmtilesReader& reader) {
    struct Enough {};
    Walk walk;
    try {
        const auto result = reader.forEach([&](const TileId& id, uint64_t offset, uint32_t length) {
            if (walk.tiles.size() == kMostTiles) throw Enough();
            walk.tiles.push_back({id, {offset, length}});
        });
        walk.isWhole = result.ok();
    } catch (const Enough&) {
        // forEach has no other end.
    }
    return walk;
}

void checkTile(const PmtilesReader& reader, const SeenTile& tile, ByteView archive) {
    const PmtilesHeader& header = reader.header();
    TERRAY_CHECK(tile.id.valid());
    TERRAY_CHECK_OP(tile.range.offset, >=, header.tilesOffset);
    TERRAY_CHECK_OP(tile.range.offset - header.tilesOffset, <=, header.tilesLength);
    TERRAY_CHECK_OP(tile.range.length, <=, header.tilesLength - (tile.range.offset - header.tilesOffset));
    const auto bytes = reader.read(tile.id);
    TERRAY_CHECK(bytes.ok() && *bytes);
    TERRAY_CHECK(std::ranges::equal(**bytes, archive.subspan(tile.range.offset, tile.range.length)));
    TERRAY_CHECK(reader.locate(tile.id).value() == tile.range);
}

}  // namespace

bool readArchive(ByteView bytes) {
    const size_t limitBytes = limitFor(bytes);
    const AllocationLimit limit(limitBytes);
    const auto reader = PmtilesReader::open(std::make_unique<MemorySource>(bytes));
    if (!reader.ok()) return false;
    const bool hasMetadata = reader->metadata().ok();
    const Walk tiles = walk(*reader);
    reader->forgetLeaves();
    for (const SeenTile& tile : tiles.tiles) {
        if (tiles.isWhole)
            checkTile(*reader, tile, bytes);
        else
            (void)reader->read(tile.id).ok();
    }
    for (const TileId id : {TileId{}, TileId{1, 1, 0}, TileId{kMaxTileLevel, 0, 0}}) (void)reader->read(id).ok();
    return hasMetadata && tiles.isWhole;
}

}  // namespace terray::fuzz
