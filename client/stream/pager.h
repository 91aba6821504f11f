#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "client/stream/dataset_source.h"
#include "client/stream/selection.h"
#include "client/stream/tile_reads.h"

namespace terray {

struct PagerOptions {
    uint64_t hostBudgetBytes = 1ull << 30;  ///< for decoded tiles held in main memory
    int decodeThreads = 0;                  ///< 0: one less than the cores, at least 1
    int maxRequestsInFlight = 16;
    bool cancelReads = true;  ///< take back reads under way that are no longer wanted, where the source can
    int64_t healMs = 10000;   ///< a tile that was damaged on its way is not asked for again before
};

/// A tile that has arrived, decoded and checked. Shared so that an eviction cannot pull it away from an upload.
struct LoadedTile {
    TileLayer layer = TileLayer::heights;
    TileId id;
    std::shared_ptr<const HeightTile> heights;   ///< for TileLayer::heights
    std::shared_ptr<const Bytes> imageryChain;   ///< for TileLayer::imagery: gatherMipChain of the tile
    std::shared_ptr<const ImageryTile> imagery;  ///< for TileLayer::imagery
};

/// How a tile is lost.
enum class Loss : uint8_t {
    forGood,      ///< what is stored is damaged or missing: it is not asked for again
    damaged,      ///< as it came over a network: it may be asked for again, a while later
    unreachable,  ///< the server or the network is out of reach for now: it may be asked for again
};

/// A tile that could not be had: every request ends as a LoadedTile or as one of these, exactly once.
struct FailedTile {
    TileLayer layer = TileLayer::heights;
    TileId id;
    std::string message;
    Loss loss = Loss::forGood;
};

/// What was read ahead of being wanted. Tiles, ancestors that a photo needs among them.
struct PrefetchStatistics {
    uint64_t tiles = 0;      ///< read
    uint64_t bytes = 0;      ///< of these, as stored
    uint64_t usedTiles = 0;  ///< of these, wanted later while they were still held
    uint64_t usedBytes = 0;
    uint64_t answered = 0;   ///< requests for what had been read ahead
    uint64_t joined = 0;     ///< requests for what was being read ahead just then; not among the tiles
    uint64_t cancelled = 0;  ///< requests, in favour of wanted ones or because the camera turned
    uint64_t failed = 0;     ///< requests; not told, and not repeated for a while
};

struct PagerStatistics {
    uint64_t requested = 0;  ///< put into the IO thread's queue; what stays wanted counts once
    uint64_t delivered = 0;  ///< taken, or waiting to be
    uint64_t failed = 0;
    uint64_t cancelled = 0;    ///< no longer wanted before they were read, or before they were taken
    uint64_t hostHits = 0;     ///< answered from main memory instead
    uint64_t bytesRead = 0;    ///< stored bytes read from the source
    uint64_t hostBytes = 0;    ///< held now
    uint64_t comingBytes = 0;  ///< main memory that is reserved for tiles on their way
    uint64_t untaken = 0;      ///< tiles that wait to be taken
    uint64_t evicted = 0;
    TileReadStatistics reads;
    PrefetchStatistics prefetch;  ///< apart from all counts of requests above
};

/// Brings wanted tiles from a source to main memory without ever blocking the render thread: one IO thread reads in
/// order of priority, one after the other from a disk, side by side over a network; workers decode. All functions are
/// for the render thread.
///
/// The queue is replaced by each want(): what is no longer wanted is cancelled, over a network also while it is read,
/// and so is what has arrived but was not taken; duplicates join. So never more tiles wait to be taken than the last
/// want() named and were in flight then.
/// Imagery brings its ancestors along, since its mip chain is gathered from them. A tile whose bytes are damaged is
/// read once more; one that failed for good is not asked for again in this session, its ancestor goes on standing in.
/// What may be wanted soon is read when nothing wanted waits to be read, and given up for what is wanted, over a
/// network also while it is read; it is not delivered, but held in main memory, and told for what it says of its
/// children. Main memory is an LRU cache under hostBudgetBytes; a tile whose descendants are held is kept as long as
/// they are, and tiles in flight are counted before they arrive. A budget too small for what is in flight delays
/// requests; one request (a height tile, or a photo tile with the ancestors it lacks) always proceeds, and only it may
/// exceed the budget. Tiles delivered, taken or not, no longer count once the cache has let them go. At any time
/// requested + hostHits = delivered + failed + cancelled + what is queued or in flight.
class Pager {
  public:
    Pager(const TileSource& source, const PagerOptions& options);
    ~Pager();  ///< joins its threads; requests in flight are dropped
    Pager(const Pager&) = delete;
    Pager& operator=(const Pager&) = delete;

    /// States everything that is wanted now, most urgent first; replaces what was wanted before.
    /// A tile that has been taken and is wanted again is delivered again.
    /// @param ahead  what may be wanted soon, most urgent first
    void want(const std::vector<TileRequest>& wanted, const std::vector<TileRequest>& ahead = {});
    /// What has arrived since the last call, in order of arrival, at most maxTiles of it.
    [[nodiscard]] std::vector<LoadedTile> takeLoaded(size_t maxTiles);
    [[nodiscard]] std::vector<FailedTile> takeFailed();
    /// What has been read ahead since the last call.
    [[nodiscard]] std::vector<LoadedTile> takeAhead();
    /// Blocks until nothing wanted is queued, being read or being decoded (all wanted have been settled).
    void waitUntilSettled();
    [[nodiscard]] PagerStatistics statistics() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace terray
