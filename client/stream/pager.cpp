#include "client/stream/pager.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <unordered_set>
#include <utility>

#include "client/stream/host_cache.h"
#include "common/check.h"

namespace terray {
namespace {

using KeySet = std::unordered_set<TileKey, TileKeyHash>;

/// How often a tile is read before it counts as failed: bytes may be damaged on their way.
constexpr int kReads = 2;

/// One tile on its way from the source.
struct Part {
    TileKey key;
    std::optional<Bytes> payload;  ///< read, not yet decoded
    HeldTile tile;                 ///< once decoded, or held from the start
    bool fetched = false;          ///< this job reads it, and has reserved memory for it
    int reads = 0;
    std::string trouble;  ///< what went wrong last
    [[nodiscard]] bool done() const { return tile.bytes > 0; }
    [[nodiscard]] bool lost() const { return !done() && !payload && reads >= kReads; }
};

/// A request that has been begun.
struct Job {
    TileKey key;
    /// What the request needs: the tile, and for imagery the ancestors that its mip chain is gathered from. Coarse to
    /// fine, so the tile itself is last. Those that were held are done from the start.
    std::vector<Part> parts;
    std::shared_ptr<const Bytes> imageryChain;
};

/// The tiles that a request needs, coarse to fine.
std::vector<TileKey> needsOf(const TileKey& key) {
    std::vector<TileKey> needs;
    const uint32_t above = key.layer == TileLayer::imagery ? std::min<uint32_t>(key.id.level, kImageryMips - 1) : 0;
    for (uint32_t levels = above; levels > 0; --levels) needs.push_back({key.layer, key.id.ancestor(levels)});
    needs.push_back(key);
    return needs;
}

void readPart(Part& part, const TileSource& source) {
    ++part.reads;
    auto payload = source.read(part.key.layer, part.key.id);
    if (payload)
        part.payload = std::move(*payload);
    else
        part.trouble = payload.failure().message;
}

void decodePart(Part& part) {
    const Bytes payload = std::move(*part.payload);
    part.payload.reset();
    const auto accept = [&part](auto& decoded, auto& place) {
        if (!decoded) {
            part.trouble = decoded.failure().message;
            return;
        }
        place = std::make_shared<std::remove_cvref_t<decltype(*decoded)>>(std::move(*decoded));
        part.tile.bytes = hostBytesOf(part.key);
    };
    if (part.key.layer == TileLayer::heights) {
        auto decoded = decodeHeightTile(payload, part.key.id);
        accept(decoded, part.tile.heights);
    } else {
        auto decoded = decodeImageryTile(payload, part.key.id);
        accept(decoded, part.tile.imagery);
    }
}

/// The mip chain of a photo tile whose parts are all there.
std::shared_ptr<const Bytes> gatherChain(const std::vector<Part>& parts) {
    std::vector<const ImageryTile*> ancestors;  // the parent first
    for (size_t i = parts.size() - 1; i-- > 0;) ancestors.push_back(parts[i].tile.imagery.get());
    return std::make_shared<const Bytes>(gatherMipChain(*parts.back().tile.imagery, ancestors));
}

LoadedTile loadedTile(const TileKey& key, const HeldTile& tile, std::shared_ptr<const Bytes> chain) {
    return {key.layer, key.id, tile.heights, std::move(chain), tile.imagery};
}

std::string describe(const TileKey& key) {
    return (key.layer == TileLayer::heights ? "height tile " : "imagery tile ") + toString(key.id);
}

}  // namespace

/// Everything behind one mutex; reading and decoding happen outside it, on a Job that only one thread has at a time.
struct Pager::State {
    using JobPtr = std::unique_ptr<Job>;

    State(const TileSource& tileSource, const PagerOptions& pagerOptions) : source(tileSource), options(pagerOptions) {}

    void accept(const TileKey& key, bool queuedBefore);
    [[nodiscard]] JobPtr nextJob();
    [[nodiscard]] JobPtr begin(const TileKey& key);
    void fail(const TileKey& key, const std::string& message);
    void deliver(LoadedTile tile);
    void dropUntaken(const KeySet& wanted);
    void finish(JobPtr job);
    void readLoop();
    void decodeLoop();
    [[nodiscard]] bool isSettled() const { return queue.empty() && busy.empty(); }

    const TileSource& source;
    const PagerOptions options;
    mutable std::mutex mutex;
    std::condition_variable ioWork, decodeWork, settled;
    bool stopping = false;

    std::deque<TileKey> queue;  ///< wanted and not begun, most urgent first
    KeySet busy;                ///< requests begun
    KeySet coming;              ///< tiles being read or decoded, for requests or as their ancestors
    KeySet untaken;             ///< delivered, not yet taken
    KeySet lost;                ///< tiles that could not be had
    KeySet refused;             ///< requests that failed: not taken up again
    std::deque<JobPtr> toRead;  ///< to be read once more
    std::deque<JobPtr> toDecode;
    HostCache cache;
    uint64_t reserved = 0;  ///< bytes that the tiles in `coming` will take
    std::deque<LoadedTile> loaded;
    std::vector<FailedTile> failed;
    PagerStatistics count;
    std::vector<std::thread> threads;
};

/// Puts a wanted tile on its way, unless it is so already or never will be.
void Pager::State::accept(const TileKey& key, bool queuedBefore) {
    if (busy.contains(key) || untaken.contains(key) || refused.contains(key)) return;
    const auto needs = needsOf(key);
    if (!std::all_of(needs.begin(), needs.end(), [this](const TileKey& need) { return cache.holds(need); })) {
        queue.push_back(key);
        count.requested += queuedBefore ? 0 : 1;
        return;
    }
    count.hostHits += queuedBefore ? 0 : 1;
    if (key.layer == TileLayer::heights) {
        deliver(loadedTile(key, *cache.use(key), nullptr));
        return;
    }
    toDecode.push_back(begin(key));  // only its chain is to be gathered, by a worker
    decodeWork.notify_one();
}

/// The job that the IO thread should read now; nullptr when there is none, or it has to wait for others to end.
Pager::State::JobPtr Pager::State::nextJob() {
    if (!toRead.empty()) {
        JobPtr job = std::move(toRead.front());
        toRead.pop_front();
        return job;
    }
    if (busy.size() >= static_cast<size_t>(options.maxRequestsInFlight)) return nullptr;
    for (auto place = queue.begin(); place != queue.end();) {
        const TileKey key = *place;
        const auto needs = needsOf(key);
        const auto bad =
            std::find_if(needs.begin(), needs.end(), [this](const auto& need) { return lost.contains(need); });
        if (bad != needs.end()) {
            place = queue.erase(place);
            fail(key, describe(key) + " needs " + describe(*bad) + ", which could not be had");
            continue;
        }
        // A tile that another request brings is not read twice: that request comes first.
        if (std::any_of(needs.begin(), needs.end(), [this](const auto& need) { return coming.contains(need); })) {
            ++place;
            continue;
        }
        uint64_t missing = 0;
        for (const TileKey& need : needs) missing += cache.holds(need) ? 0 : hostBytesOf(need);
        if (reserved + missing > options.hostBudgetBytes && !busy.empty()) return nullptr;
        queue.erase(place);
        return begin(key);
    }
    return nullptr;
}

/// Takes what is held, reserves memory for the rest.
Pager::State::JobPtr Pager::State::begin(const TileKey& key) {
    auto job = std::make_unique<Job>();
    job->key = key;
    for (const TileKey& need : needsOf(key)) {
        Part part{.key = need};
        if (const HeldTile* held = cache.use(need)) {
            part.tile = *held;
        } else {
            part.fetched = true;
            coming.insert(need);
            reserved += hostBytesOf(need);
        }
        job->parts.push_back(std::move(part));
    }
    const uint64_t budget = options.hostBudgetBytes;
    count.evicted += cache.shrinkTo(budget - std::min(budget, reserved));
    busy.insert(key);
    return job;
}

void Pager::State::fail(const TileKey& key, const std::string& message) {
    refused.insert(key);
    failed.push_back({key.layer, key.id, message});
    ++count.failed;
    if (isSettled()) settled.notify_all();
}

void Pager::State::deliver(LoadedTile tile) {
    untaken.insert({tile.layer, tile.id});
    loaded.push_back(std::move(tile));
    ++count.delivered;
}

/// Cancels what has arrived, was not taken, and is not wanted any more; else a slow taker would gather tiles for ever.
void Pager::State::dropUntaken(const KeySet& wanted) {
    const auto dropped = std::erase_if(loaded, [&](const LoadedTile& tile) {
        const TileKey key{tile.layer, tile.id};
        return !wanted.contains(key) && untaken.erase(key) > 0;
    });
    count.delivered -= dropped;
    count.cancelled += dropped;
}

/// Settles a request: all its parts are there, or one is lost.
void Pager::State::finish(JobPtr job) {
    const Part* bad = nullptr;
    for (const Part& part : job->parts) {
        if (part.lost() && bad == nullptr) bad = &part;
        if (!part.fetched) continue;
        coming.erase(part.key);
        reserved -= hostBytesOf(part.key);
        if (part.done()) cache.insert(part.key, part.tile);
    }
    const uint64_t budget = options.hostBudgetBytes;
    count.evicted += cache.shrinkTo(budget - std::min(budget, reserved));
    busy.erase(job->key);
    if (bad != nullptr) {
        lost.insert(bad->key);
        fail(job->key,
             describe(job->key) + " could not be had: " + describe(bad->key) + " was read twice: " + bad->trouble);
    } else {
        deliver(loadedTile(job->key, job->parts.back().tile, job->imageryChain));
    }
    ioWork.notify_one();
    if (isSettled()) settled.notify_all();
}

void Pager::State::readLoop() {
    std::unique_lock lock(mutex);
    while (!stopping) {
        JobPtr job = nextJob();
        if (!job) {
            ioWork.wait(lock);
            continue;
        }
        lock.unlock();
        uint64_t bytes = 0;
        for (Part& part : job->parts) {
            if (part.done()) continue;
            while (!part.payload && !part.lost()) readPart(part, source);
            if (part.lost()) break;
            bytes += part.payload->size();
        }
        lock.lock();
        count.bytesRead += bytes;
        toDecode.push_back(std::move(job));
        decodeWork.notify_one();
    }
}

void Pager::State::decodeLoop() {
    std::unique_lock lock(mutex);
    for (;;) {
        decodeWork.wait(lock, [this] { return stopping || !toDecode.empty(); });
        if (stopping) return;
        JobPtr job = std::move(toDecode.front());
        toDecode.pop_front();
        lock.unlock();
        bool complete = true, hopeless = false;
        for (Part& part : job->parts) {
            if (part.payload) decodePart(part);
            complete = complete && part.done();
            hopeless = hopeless || part.lost();
        }
        if (complete && job->key.layer == TileLayer::imagery) job->imageryChain = gatherChain(job->parts);
        lock.lock();
        if (complete || hopeless) {
            finish(std::move(job));
        } else {
            toRead.push_back(std::move(job));
            ioWork.notify_one();
        }
    }
}

Pager::Pager(const TileSource& source, const PagerOptions& options) : state_(std::make_unique<State>(source, options)) {
    TERRAY_CHECK_OP(options.maxRequestsInFlight, >, 0);
    TERRAY_CHECK_OP(options.decodeThreads, >=, 0);
    const int cores = static_cast<int>(std::thread::hardware_concurrency());
    const int workers = options.decodeThreads > 0 ? options.decodeThreads : std::max(1, cores - 1);
    state_->threads.emplace_back([state = state_.get()] { state->readLoop(); });
    for (int i = 0; i < workers; ++i) state_->threads.emplace_back([state = state_.get()] { state->decodeLoop(); });
}

Pager::~Pager() {
    {
        const std::lock_guard lock(state_->mutex);
        state_->stopping = true;
    }
    state_->ioWork.notify_all();
    state_->decodeWork.notify_all();
    for (std::thread& thread : state_->threads) thread.join();
}

void Pager::want(const std::vector<TileRequest>& wanted) {
    const std::lock_guard lock(state_->mutex);
    KeySet before(state_->queue.begin(), state_->queue.end());
    state_->queue.clear();
    KeySet seen;
    for (const TileRequest& request : wanted) {
        const TileKey key{request.layer, request.id};
        if (seen.insert(key).second) state_->accept(key, before.erase(key) > 0);
    }
    state_->count.cancelled += before.size();
    state_->dropUntaken(seen);
    state_->ioWork.notify_one();
    if (state_->isSettled()) state_->settled.notify_all();
}

std::vector<LoadedTile> Pager::takeLoaded(size_t maxTiles) {
    const std::lock_guard lock(state_->mutex);
    std::vector<LoadedTile> taken;
    while (!state_->loaded.empty() && taken.size() < maxTiles) {
        taken.push_back(std::move(state_->loaded.front()));
        state_->loaded.pop_front();
        state_->untaken.erase({taken.back().layer, taken.back().id});
    }
    return taken;
}

std::vector<FailedTile> Pager::takeFailed() {
    const std::lock_guard lock(state_->mutex);
    return std::exchange(state_->failed, {});
}

void Pager::waitUntilSettled() {
    std::unique_lock lock(state_->mutex);
    state_->settled.wait(lock, [this] { return state_->isSettled(); });
}

PagerStatistics Pager::statistics() const {
    const std::lock_guard lock(state_->mutex);
    PagerStatistics now = state_->count;
    now.hostBytes = state_->cache.bytes();
    return now;
}

}  // namespace terray
