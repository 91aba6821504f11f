#include "server/tile_store.h"

#include <utility>

#include "common/check.h"

namespace terray::server {
namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;
constexpr size_t kEntryBytes = 256;  // what a kept tile takes beside its bytes: list and map nodes, control block
constexpr size_t kMostParents = 64;  // older wishes to read ahead are forgotten: their client has gone on

void add(std::atomic<uint64_t>& counter) {
    counter.fetch_add(1, kRelaxed);
}

/// What a kept tile counts as.
uint64_t costOf(uint64_t size) {
    return TileMemory::roomFor(size) + kEntryBytes;
}

}  // namespace

TileStore::TileStore(TileStoreOptions options, Metrics& metrics) : options_(options), metrics_(metrics) {
    for (int i = 0; i < options_.readers; ++i) readers_.emplace_back([this] { runReader(); });
}

TileStore::~TileStore() {
    {
        const std::lock_guard lock(mutex_);
        stops_ = true;
        for (const auto& [key, pending] : pending_) TERRAY_CHECK(pending.waiters.empty());
    }
    wake_.notify_all();
    for (std::thread& reader : readers_) reader.join();
}

TileBytes TileStore::find(const StoredTile& tile) {
    const std::lock_guard lock(mutex_);
    return use(tile);
}

TileBytes TileStore::use(const StoredTile& tile) {
    const auto found = kept_.find(keyOf(tile));
    if (found == kept_.end()) return nullptr;
    const auto entry = found->second;
    add(metrics_.tileHits);
    if (!entry->wasAsked) {
        add(metrics_.aheadUsed);
        aheadBytes_ -= costOf(entry->bytes->size());
    }
    asked_.splice(asked_.begin(), entriesOf(*entry), entry);
    entry->wasAsked = true;
    if (!entry->readChildren) queueChildren(*entry, tile);
    return entry->bytes;
}

void TileStore::queueChildren(Entry& entry, const StoredTile& tile) {
    entry.readChildren = true;
    if (!options_.readsAhead || tile.id.level >= tile.archive->finestLevel()) return;
    parents_.push_back(tile);
    if (parents_.size() > kMostParents) parents_.pop_front();
    wake_.notify_one();
}

void TileStore::read(const StoredTile& tile, Done done) {
    std::unique_lock lock(mutex_);
    if (TileBytes bytes = use(tile)) {  // it may have come since find()
        lock.unlock();
        done(std::move(bytes));
        return;
    }
    const Key key = keyOf(tile);
    Pending& pending = pending_.try_emplace(key, Pending{.tile = tile}).first->second;
    add(pending.isStarted || !pending.waiters.empty() ? metrics_.tileJoins : metrics_.tileReads);
    if (pending.waiters.empty() && !pending.isStarted) wanted_.push_back(key);
    pending.waiters.push_back(std::move(done));
    wake_.notify_one();
}

void TileStore::runReader() {
    std::unique_lock lock(mutex_);
    for (;;) {
        wake_.wait(lock, [&] { return stops_ || !wanted_.empty() || !parents_.empty(); });
        if (stops_) return;
        if (!wanted_.empty()) {
            const Key key = wanted_.front();
            wanted_.pop_front();
            readTile(key, lock);
        } else {
            const StoredTile parent = std::move(parents_.back());
            parents_.pop_back();
            readChildren(parent, lock);
        }
    }
}

TileBytes TileStore::readBytes(const StoredTile& tile) {
    const auto bytes = tile.archive->reader().source().read(tile.range.offset, tile.range.length);
    return bytes ? memory_.keep(*bytes) : nullptr;
}

void TileStore::readTile(const Key& key, std::unique_lock<std::mutex>& lock) {
    Pending& pending = pending_.at(key);  // stays where it is: only this thread erases it
    pending.isStarted = true;
    const StoredTile tile = pending.tile;
    lock.unlock();
    TileBytes bytes = readBytes(tile);
    lock.lock();
    const std::vector<Done> waiters = std::move(pending.waiters);
    pending_.erase(key);
    if (bytes) {
        keep(key, bytes, !waiters.empty());
        if (const auto kept = kept_.find(key); kept != kept_.end() && !waiters.empty())
            queueChildren(*kept->second, tile);
    }
    lock.unlock();
    for (const Done& done : waiters) done(bytes);
    lock.lock();
}

void TileStore::readChildren(const StoredTile& tile, std::unique_lock<std::mutex>& lock) {
    for (uint32_t quadrant = 0; quadrant < 4 && !stops_; ++quadrant) {
        if (!wanted_.empty()) return;  // a client waits: that goes before any guess
        const TileId id = tile.id.child(quadrant);
        const Key key{tile.archive->serial(), id};
        if (kept_.contains(key) || pending_.contains(key)) continue;
        lock.unlock();
        const auto range = tile.archive->reader().locate(id);
        lock.lock();
        const bool fits = range && *range && costOf((*range)->length) <= options_.budgetBytes / 4;
        if (!fits || kept_.contains(key) || pending_.contains(key)) continue;
        add(metrics_.aheadReads);
        pending_.emplace(key, Pending{.tile = {tile.archive, id, **range}, .isStarted = true});
        readTile(key, lock);
    }
}

void TileStore::keep(const Key& key, TileBytes bytes, bool wasAsked) {
    const uint64_t size = costOf(bytes->size());
    const uint64_t room = wasAsked ? options_.budgetBytes : options_.budgetBytes / 4;
    if (size > room) return;
    Entries& entries = wasAsked ? asked_ : ahead_;
    entries.push_front({.key = key, .bytes = std::move(bytes), .wasAsked = wasAsked});
    kept_[key] = entries.begin();
    bytes_ += size;
    if (!wasAsked) aheadBytes_ += size;
    evict();
}

void TileStore::evict() {
    while (aheadBytes_ > options_.budgetBytes / 4) drop(ahead_);
    while (bytes_ > options_.budgetBytes) drop(asked_.empty() ? ahead_ : asked_);
    metrics_.cacheBytes.store(bytes_, kRelaxed);
}

void TileStore::drop(Entries& from) {
    const Entry& last = from.back();
    const uint64_t size = costOf(last.bytes->size());
    bytes_ -= size;
    if (!last.wasAsked) aheadBytes_ -= size;
    kept_.erase(last.key);
    from.pop_back();
    add(metrics_.tileEvictions);
}

}  // namespace terray::server
