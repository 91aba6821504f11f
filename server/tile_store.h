#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <thread>
#include <unordered_map>
#include <vector>

#include "common/tile_id.h"
#include "server/metrics.h"
#include "server/served_dataset.h"
#include "server/tile_memory.h"

namespace terray::server {

/// The bytes of a stored tile in memory; null: they cannot be read, or there is no memory for them.
using TileBytes = std::shared_ptr<const KeptTile>;

/// A tile of an archive, found already.
struct StoredTile {
    std::shared_ptr<const ServedArchive> archive;
    TileId id;
    ByteRange range;
};

struct TileStoreOptions {
    uint64_t budgetBytes = uint64_t{256} << 20;  ///< of tiles kept, in whole pages
    int readers = 4;                             ///< threads that wait for the disk, so that no connection's does
    bool readsAhead = true;
};

/// Reads tiles on threads of its own and keeps those asked for last. Requests for a tile that is being read join that
/// one read. A tile that is asked for makes its four children be read ahead, which is what a client that comes nearer
/// asks for next; those wait for requests, and take at most a quarter of the budget until they are asked for.
///
/// Thread-safe. Tiles handed out live on outside the budget for as long as someone holds them.
class TileStore {
  public:
    using Done = std::function<void(TileBytes)>;

    /// @param metrics  counts hits, reads and bytes; must live longer
    TileStore(TileStoreOptions options, Metrics& metrics);
    /// Every request must have been settled.
    ~TileStore();
    TileStore(const TileStore&) = delete;
    TileStore& operator=(const TileStore&) = delete;

    /// The tile if it is kept, else null. Reads its children ahead, once for as long as it is kept.
    [[nodiscard]] TileBytes find(const StoredTile& tile);
    /// Reads a tile. @param done  called exactly once, on a reader's thread or before this returns
    void read(const StoredTile& tile, Done done);

  private:
    struct Key {
        uint64_t archive = 0;  ///< ServedArchive::serial()
        TileId id;
        bool operator==(const Key&) const = default;
    };
    struct KeyHash {
        size_t operator()(const Key& key) const { return std::hash<TileId>()(key.id) ^ (key.archive << 32); }
    };
    struct Entry {
        Key key;
        TileBytes bytes;
        bool wasAsked = false;      ///< by a client; otherwise it was read ahead
        bool readChildren = false;  ///< they have been read ahead, or are to be
    };
    using Entries = std::list<Entry>;  ///< last used first
    struct Pending {
        StoredTile tile;
        std::vector<Done> waiters;
        bool isStarted = false;
    };

    [[nodiscard]] static Key keyOf(const StoredTile& tile) { return {tile.archive->serial(), tile.id}; }
    [[nodiscard]] Entries& entriesOf(const Entry& entry) { return entry.wasAsked ? asked_ : ahead_; }
    // All below: the lock is held, except in runReader(), readTile() and readBytes().
    [[nodiscard]] TileBytes readBytes(const StoredTile& tile);
    [[nodiscard]] TileBytes use(const StoredTile& tile);
    void keep(const Key& key, TileBytes bytes, bool wasAsked);
    void evict();
    void drop(Entries& from);
    void queueChildren(Entry& entry, const StoredTile& tile);
    void runReader();
    void readTile(const Key& key, std::unique_lock<std::mutex>& lock);
    void readChildren(const StoredTile& tile, std::unique_lock<std::mutex>& lock);

    TileStoreOptions options_;
    Metrics& metrics_;
    TileMemory memory_;
    std::mutex mutex_;
    std::condition_variable wake_;
    bool stops_ = false;
    Entries asked_, ahead_;
    uint64_t bytes_ = 0, aheadBytes_ = 0;  ///< of both lists; of ahead_
    std::unordered_map<Key, Entries::iterator, KeyHash> kept_;
    std::unordered_map<Key, Pending, KeyHash> pending_;
    std::deque<Key> wanted_;            ///< keys of pending_ that someone waits for
    std::deque<StoredTile> parents_;    ///< whose children are to be read when nothing is wanted; the newest last
    std::vector<std::thread> readers_;  ///< last: begin when all else is there
};

}  // namespace terray::server
