#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "client/stream/dataset_source.h"
#include "client/stream/disk_cache.h"

namespace terray {

/// How a read of a tile ended.
struct TileRead {
    uint64_t ticket = 0;
    Result<Bytes> payload;  ///< as stored, not looked into
    bool reachable = true;  ///< false: the failure is a server's or the network's of the moment
};

struct TileReadStatistics {
    uint64_t receivedBytes = 0;  ///< that came from the source, directories and what was given up among them
    uint64_t retries = 0;        ///< of requests over a network
    DiskCacheStatistics diskCache;
};

/// Reads of stored tiles that run side by side, driven by one thread that never waits for one of them: the pager's. A
/// read that was begun ends exactly once, by cancel() or in an answer of wait().
class TileReads {
  public:
    virtual ~TileReads() = default;
    /// How many tiles to read at a time at most, for a source that gains nothing from more.
    [[nodiscard]] virtual size_t atATime() const = 0;
    /// Whether a tile that is damaged now may be whole later, as over a network.
    [[nodiscard]] virtual bool mayHeal() const = 0;
    /// @param ticket  names the read; of none that runs
    /// @param again   what this tile's last read gave was damaged: ask the source itself, not a cache
    virtual void begin(uint64_t ticket, TileLayer layer, const TileId& id, bool again) = 0;
    /// @return true: the read will not end any more. False: it is too late for that
    [[nodiscard]] virtual bool cancel(uint64_t ticket) = 0;
    /// Drives the reads. @param block  whether to wait until some have ended or wake() is called
    /// @return what has ended; may be empty
    [[nodiscard]] virtual std::vector<TileRead> wait(bool block) = 0;
    /// Ends a wait() that runs, or else the next one. Any thread.
    virtual void wake() = 0;
    [[nodiscard]] virtual TileReadStatistics statistics() const = 0;
};

/// Reads by TileSource::read, one after the other, each within begin(): for sources that answer at once.
/// @param source  outlives the answer
[[nodiscard]] std::unique_ptr<TileReads> readOneByOne(const TileSource& source);

}  // namespace terray
