#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bytes.h"
#include "common/result.h"
#include "common/tile_id.h"

namespace terray {

// PMTiles v3: one file with a 127-byte header, directories of varints, JSON metadata and tiles, ordered along a Hilbert
// curve so that it can be read by ranges. Source: protomaps/PMTiles, spec/v3/spec.md.

/// Position of a tile on the Hilbert curves of all levels, coarse levels first: 0/0/0 is 0, 1/0/0 is 1, 1/0/1 is 2,
/// 1/1/1 is 3, 1/1/0 is 4. The id must be valid().
[[nodiscard]] uint64_t hilbertId(const TileId& id);
/// The inverse; fails for numbers beyond level kMaxTileLevel.
[[nodiscard]] Result<TileId> tileFromHilbert(uint64_t hilbert);

enum class PmtilesCompression : uint8_t { unknown = 0, none = 1, gzip = 2, brotli = 3, zstd = 4 };

/// The fixed header, fields as in the specification. Offsets and lengths in bytes.
struct PmtilesHeader {
    uint64_t rootOffset = 0, rootLength = 0;
    uint64_t metadataOffset = 0, metadataLength = 0;
    uint64_t leavesOffset = 0, leavesLength = 0;
    uint64_t tilesOffset = 0, tilesLength = 0;
    uint64_t addressedTiles = 0, tileEntries = 0, tileContents = 0;
    bool clustered = true;
    PmtilesCompression internalCompression = PmtilesCompression::none;
    PmtilesCompression tileCompression = PmtilesCompression::none;
    uint8_t tileType = 0;  ///< 0: unknown, which is what ours are
    uint8_t minZoom = 0, maxZoom = 0;
    double minLon = 0, minLat = 0, maxLon = 0, maxLat = 0;  ///< degrees, stored in steps of 1e-7
    uint8_t centerZoom = 0;
    double centerLon = 0, centerLat = 0;

    bool operator==(const PmtilesHeader&) const = default;
};
inline constexpr size_t kPmtilesHeaderBytes = 127;

[[nodiscard]] Bytes encodePmtilesHeader(const PmtilesHeader& header);
[[nodiscard]] Result<PmtilesHeader> decodePmtilesHeader(ByteView bytes);

/// One line of a directory: a run of tiles that share their bytes, or (runLength 0) a leaf directory.
struct PmtilesEntry {
    uint64_t tileId = 0;
    uint64_t offset = 0;  ///< from the start of the tile data, or of the leaf directories
    uint32_t length = 0;
    uint32_t runLength = 0;

    bool operator==(const PmtilesEntry&) const = default;
};
[[nodiscard]] Bytes encodePmtilesDirectory(const std::vector<PmtilesEntry>& entries);
/// Ids must ascend, lengths must not be 0, runs must not overlap; allocates no more than the bytes can hold.
[[nodiscard]] Result<std::vector<PmtilesEntry>> decodePmtilesDirectory(ByteView bytes);

/// Random access to the bytes of an archive: a file, or a web server. Calls may come from several threads at once.
class ByteSource {
  public:
    virtual ~ByteSource() = default;
    /// Exactly `length` bytes from `offset`; fails when they are not all there.
    virtual Result<Bytes> read(uint64_t offset, uint64_t length) const = 0;
    /// Bytes in all.
    virtual uint64_t size() const = 0;
    /// For messages: a path or an address.
    virtual std::string name() const = 0;
    /// The open local file behind it, for sendfile; none when it is something else. Closed with the source.
    virtual std::optional<int> descriptor() const { return {}; }
};
/// A local file read by pread. Fails when it cannot be opened.
[[nodiscard]] Result<std::unique_ptr<ByteSource>> openFileSource(const std::filesystem::path& path);

/// Some bytes of an archive.
struct ByteRange {
    uint64_t offset = 0;
    uint64_t length = 0;
    bool operator==(const ByteRange&) const = default;
};

/// Reads an archive. Thread-safe after open(); leaf directories are read when a tile beneath them is first asked for,
/// and cached (bounded).
class PmtilesReader {
  public:
    /// Checks the header and the root directory against the source's size: a truncated archive fails here.
    [[nodiscard]] static Result<PmtilesReader> open(std::unique_ptr<ByteSource> source);
    PmtilesReader(PmtilesReader&&) noexcept;
    PmtilesReader& operator=(PmtilesReader&&) noexcept;
    ~PmtilesReader();

    [[nodiscard]] const PmtilesHeader& header() const;
    /// The JSON metadata, decompressed.
    [[nodiscard]] Result<std::string> metadata() const;
    /// Where in the file a tile's bytes lie; no value inside the optional when the archive has no such tile. Reads at
    /// most the leaf directories on the way, and none that is cached.
    [[nodiscard]] Result<std::optional<ByteRange>> locate(const TileId& id) const;
    /// The stored bytes of a tile; no value inside the optional when the archive has no such tile.
    [[nodiscard]] Result<std::optional<Bytes>> read(const TileId& id) const;
    class Lookup;
    /// Begins the way to a tile without reading anything; the reader must outlive the answer.
    [[nodiscard]] Result<Lookup> lookUp(const TileId& id) const;
    /// Drops the cached leaf directories, where their bytes may have been damaged on their way.
    void forgetLeaves() const;
    /// Calls visit(tile, offset in the file, length) for every tile in Hilbert order, run by run expanded; stops at the
    /// first failure. Offsets are checked against the archive's tile section.
    [[nodiscard]] Result<void> forEach(const std::function<void(const TileId&, uint64_t, uint32_t)>& visit) const;
    [[nodiscard]] const ByteSource& source() const;

  private:
    struct State;
    explicit PmtilesReader(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

/// The way from an archive's root directory to a tile, one piece at a time, for whoever fetches the bytes himself and
/// cannot wait for them. What the reader's cache holds is not asked for. One thread.
class PmtilesReader::Lookup {
  public:
    /// The bytes of the archive that are needed next; none: the archive has no such tile.
    [[nodiscard]] const std::optional<ByteRange>& range() const { return range_; }
    /// Whether they are a leaf directory on the way, to be handed to takeLeaf(); else they are the tile.
    [[nodiscard]] bool isLeaf() const { return isLeaf_; }
    /// Goes on with the bytes that range() named. Fails when they are no directory, as a damaged one.
    [[nodiscard]] Result<void> takeLeaf(ByteView bytes);

  private:
    friend class PmtilesReader;
    Lookup(const State& state, uint64_t tile) : state_(&state), tile_(tile) {}
    [[nodiscard]] Result<void> descend(const std::vector<PmtilesEntry>& directory);

    const State* state_;
    uint64_t tile_;
    int leafLevel_ = 0;
    std::optional<ByteRange> range_;
    bool isLeaf_ = false;
};

/// Options of both ways to write an archive.
struct PmtilesWriteOptions {
    PmtilesCompression internalCompression = PmtilesCompression::none;  ///< none or gzip (needs zlib)
    size_t maxRootBytes = 16384 - kPmtilesHeaderBytes;                  ///< the specification's bound
    size_t leafEntries = 4096;  ///< of a leaf directory, doubled until the root that points to the leaves fits
};

/// Tiles whose ids and lengths are known before their bytes are at hand. No two contents may be equal: nothing shares
/// its bytes here.
struct PmtilesContents {
    /// Tells every tile, ids ascending in Hilbert order and lengths above 0; called more than once, with the same
    /// answer.
    std::function<void(const std::function<void(const TileId& id, uint32_t length)>& tell)> list;
    /// Hands over the bytes of every tile in that order; called once.
    std::function<void(const std::function<void(ByteView payload)>& write)> payloads;
};

/// Writes a clustered archive straight into place: by way of `path` with ".tmp" appended, synced and renamed. The same
/// bytes as PmtilesWriter's for different contents, but the tiles are written once only, and memory holds one leaf and
/// the packed directories (some 6 bytes a tile).
///
/// @param metadata  JSON text
/// @param header    zoom range, bounds and centre are taken from it; everything else is filled in
/// Throws Error(output) when the disk is full or not writable.
void writePmtiles(const std::filesystem::path& path, const std::string& metadata, const PmtilesHeader& header,
                  const PmtilesContents& contents, const PmtilesWriteOptions& options = {});

/// Writes a clustered archive front to back. Tile data goes to a temporary file beside the target, because the
/// directories that precede it are known only at the end; finish() puts the parts together, syncs, and renames. Without
/// finish() nothing is left behind. Same tiles, same bytes. One thread.
///
/// Throws Error(output) when the disk is full or not writable.
class PmtilesWriter {
  public:
    using Options = PmtilesWriteOptions;
    explicit PmtilesWriter(std::filesystem::path path);
    PmtilesWriter(std::filesystem::path path, Options options);
    ~PmtilesWriter();
    PmtilesWriter(const PmtilesWriter&) = delete;
    PmtilesWriter& operator=(const PmtilesWriter&) = delete;

    /// Adds a tile; ids must ascend in Hilbert order. Equal contents of neighbours in the order share their bytes.
    void add(const TileId& id, ByteView payload);
    /// @param metadata  JSON text
    /// @param header    zoom range, bounds and centre are taken from it; everything else is filled in
    void finish(const std::string& metadata, const PmtilesHeader& header);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace terray
