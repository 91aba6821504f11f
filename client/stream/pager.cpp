#include "client/stream/pager.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <unordered_map>
#include <utility>

#include "client/stream/host_cache.h"
#include "client/stream/job_reader.h"
#include "client/stream/pager_job.h"
#include "common/check.h"

namespace terray {
namespace {

using Clock = std::chrono::steady_clock;

/// Requests under way, wanted ones among them, up to which others are read ahead.
constexpr size_t kMostReadsAhead = 4;

LoadedTile loadedTile(const TileKey& key, const HeldTile& tile, std::shared_ptr<const Bytes> chain) {
    return {key.layer, key.id, tile.heights, std::move(chain), tile.imagery};
}

}  // namespace

/// Everything but the reader, which is the IO thread's, behind one mutex; reading and decoding happen outside it.
struct Pager::State {
    using JobPtr = JobReader::JobPtr;

    State(const TileSource& source, const PagerOptions& pagerOptions)
        : options(pagerOptions), reader(source.startReads()), mayHeal(reader.mayHeal()) {}

    void accept(const TileKey& key, bool queuedBefore);
    void acceptAhead(const TileKey& key);
    [[nodiscard]] JobPtr nextJob();
    [[nodiscard]] JobPtr nextJobAhead();
    [[nodiscard]] bool mayBegin(const std::vector<TileKey>& needs, uint64_t budget) const;
    [[nodiscard]] TileKeySet worthReading() const;
    [[nodiscard]] JobPtr begin(const TileKey& key);
    void fail(const TileKey& key, Loss loss, const std::string& message);
    [[nodiscard]] bool isRefused(const TileKey& key);
    bool noteUse(const TileKey& key);
    void finishAhead(const TileJob& job);
    void deliver(LoadedTile tile);
    void dropUntaken();
    void release(const TileJob& job);
    void handOver(std::vector<JobPtr> jobs);
    void finish(JobPtr job);
    void readLoop();
    void decodeLoop();
    [[nodiscard]] bool isSettled() const { return queue.empty() && busy.size() == ahead.busy.size(); }

    const PagerOptions options;
    JobReader reader;  ///< the IO thread's alone, but for wake()
    const bool mayHeal;
    mutable std::mutex mutex;
    std::condition_variable decodeWork, settled;
    bool stopping = false;

    std::deque<TileKey> queue;  ///< wanted and not begun, most urgent first
    TileKeySet wanted;          ///< by the last want()
    TileKeySet busy;            ///< requests begun
    TileKeySet coming;          ///< tiles being read or decoded, for requests or as their ancestors
    TileKeySet untaken;         ///< delivered, not yet taken
    TileKeySet lost;            ///< tiles that could not be had and never will
    std::unordered_map<TileKey, Clock::time_point, TileKeyHash> refused;  ///< requests not taken up before then
    /// What may be wanted soon. A request in `busy` that is not wanted yet is in ahead.busy, too.
    struct {
        std::deque<TileKey> queue;
        TileKeySet wanted;                                          ///< by the last want()
        TileKeySet busy;                                            ///< requests begun
        std::unordered_map<TileKey, uint64_t, TileKeyHash> unused;  ///< tiles read and not wanted yet: stored bytes
        std::unordered_map<TileKey, Clock::time_point, TileKeyHash> refused;
        std::vector<LoadedTile> arrived;
    } ahead;
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
    if (ahead.busy.erase(key) > 0) {
        ++count.requested;
        ++count.prefetch.joined;
    }
    if (busy.contains(key) || untaken.contains(key) || isRefused(key)) return;
    const auto needs = needsOf(key);
    if (!std::all_of(needs.begin(), needs.end(), [this](const TileKey& need) { return cache.holds(need); })) {
        queue.push_back(key);
        count.requested += queuedBefore ? 0 : 1;
        return;
    }
    count.hostHits += queuedBefore ? 0 : 1;
    if (key.layer == TileLayer::heights) {
        count.prefetch.answered += noteUse(key) ? 1 : 0;
        deliver(loadedTile(key, *cache.use(key), nullptr));
        return;
    }
    toDecode.push_back(begin(key));  // only its chain is to be gathered, by a worker
    decodeWork.notify_one();
}

/// Lets a tile be read ahead, unless there is nothing to read, or it was of no use before.
void Pager::State::acceptAhead(const TileKey& key) {
    if (wanted.contains(key) || !ahead.wanted.insert(key).second) return;
    if (busy.contains(key) || untaken.contains(key) || isRefused(key)) return;
    const auto refusal = ahead.refused.find(key);
    if (refusal != ahead.refused.end() && Clock::now() < refusal->second) return;
    if (ahead.unused.contains(key) || cache.holds(key)) return;
    ahead.queue.push_back(key);
}

/// A tile is wanted, or its photo's descendant is: if it was read ahead, that was of use. @return whether it was
bool Pager::State::noteUse(const TileKey& key) {
    const auto found = ahead.unused.find(key);
    if (found == ahead.unused.end()) return false;
    ++count.prefetch.usedTiles;
    count.prefetch.usedBytes += found->second;
    ahead.unused.erase(found);
    return true;
}

/// Whether there is memory for a request within a budget. One at a time goes ahead always.
bool Pager::State::mayBegin(const std::vector<TileKey>& needs, uint64_t budget) const {
    uint64_t missing = 0;
    for (const TileKey& need : needs) missing += cache.holds(need) ? 0 : hostBytesOf(need);
    return reserved + missing <= budget || busy.empty();
}

/// The job that the IO thread should read now; nullptr when there is none, or it has to wait for others to end.
Pager::State::JobPtr Pager::State::nextJob() {
    if (!toRead.empty()) {
        JobPtr job = std::move(toRead.front());
        toRead.pop_front();
        return job;
    }
    if (busy.size() >= static_cast<size_t>(options.maxRequestsInFlight) || !reader.hasRoom()) return nullptr;
    for (auto place = queue.begin(); place != queue.end();) {
        const TileKey key = *place;
        const auto needs = needsOf(key);
        const auto bad =
            std::find_if(needs.begin(), needs.end(), [this](const auto& need) { return lost.contains(need); });
        if (bad != needs.end()) {
            place = queue.erase(place);
            fail(key, Loss::forGood, describe(key) + " needs " + describe(*bad) + ", which could not be had");
            continue;
        }
        // A tile that another request brings is not read twice: that request comes first.
        if (std::any_of(needs.begin(), needs.end(), [this](const auto& need) { return coming.contains(need); })) {
            ++place;
            continue;
        }
        if (!mayBegin(needs, options.hostBudgetBytes)) return nullptr;
        queue.erase(place);
        return begin(key);
    }
    return queue.empty() ? nextJobAhead() : nullptr;
}

/// The next request to be read ahead, while few are under way.
Pager::State::JobPtr Pager::State::nextJobAhead() {
    while (!ahead.queue.empty() && busy.size() < kMostReadsAhead) {
        const TileKey key = ahead.queue.front();
        ahead.queue.pop_front();
        const auto needs = needsOf(key);
        const auto inTheWay = [this](const TileKey& need) { return lost.contains(need) || coming.contains(need); };
        if (std::any_of(needs.begin(), needs.end(), inTheWay)) continue;
        if (!mayBegin(needs, options.hostBudgetBytes / 4)) return nullptr;
        ahead.busy.insert(key);
        return begin(key);
    }
    return nullptr;
}

/// What reads should go on: those ahead only while nothing wanted waits.
TileKeySet Pager::State::worthReading() const {
    TileKeySet keys = wanted;
    if (queue.empty()) keys.insert(ahead.wanted.begin(), ahead.wanted.end());
    return keys;
}

/// Takes what is held, reserves memory for the rest.
Pager::State::JobPtr Pager::State::begin(const TileKey& key) {
    auto job = std::make_unique<TileJob>();
    job->key = key;
    for (const TileKey& need : needsOf(key)) {
        TilePart part{.key = need};
        if (const HeldTile* held = cache.use(need)) {
            part.tile = *held;
            if (!ahead.busy.contains(key) && noteUse(need) && need == key) ++count.prefetch.answered;
        } else {
            ahead.unused.erase(need);  // it has gone in vain
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

void Pager::State::fail(const TileKey& key, Loss loss, const std::string& message) {
    if (loss == Loss::forGood) refused[key] = Clock::time_point::max();
    if (loss == Loss::damaged) refused[key] = Clock::now() + std::chrono::milliseconds(options.healMs);
    failed.push_back({key.layer, key.id, message, loss});
    ++count.failed;
    if (isSettled()) settled.notify_all();
}

bool Pager::State::isRefused(const TileKey& key) {
    const auto found = refused.find(key);
    if (found == refused.end()) return false;
    if (Clock::now() < found->second) return true;
    refused.erase(found);
    return false;
}

void Pager::State::deliver(LoadedTile tile) {
    untaken.insert({tile.layer, tile.id});
    loaded.push_back(std::move(tile));
    ++count.delivered;
}

/// Cancels what has arrived, was not taken, and is not wanted any more; else a slow taker would gather tiles for ever.
void Pager::State::dropUntaken() {
    const auto dropped = std::erase_if(loaded, [&](const LoadedTile& tile) {
        const TileKey key{tile.layer, tile.id};
        return !wanted.contains(key) && untaken.erase(key) > 0;
    });
    count.delivered -= dropped;
    count.cancelled += dropped;
}

/// Gives back what begin() reserved, and keeps the tiles that have come.
void Pager::State::release(const TileJob& job) {
    for (const TilePart& part : job.parts) {
        if (!part.fetched) continue;
        coming.erase(part.key);
        reserved -= hostBytesOf(part.key);
        if (part.done()) cache.insert(part.key, part.tile);
    }
    const uint64_t budget = options.hostBudgetBytes;
    count.evicted += cache.shrinkTo(budget - std::min(budget, reserved));
    busy.erase(job.key);
}

/// Settles a request that is not wanted yet.
void Pager::State::finishAhead(const TileJob& job) {
    if (job.lostPart() != nullptr || !job.unreachable.empty()) {
        ++count.prefetch.failed;
        ahead.refused[job.key] = Clock::now() + std::chrono::milliseconds(options.healMs);
        return;
    }
    for (const TilePart& part : job.parts) {
        if (!part.fetched) continue;
        ++count.prefetch.tiles;
        count.prefetch.bytes += part.storedBytes;
        ahead.unused[part.key] = part.storedBytes;
        ahead.arrived.push_back(loadedTile(part.key, part.tile, nullptr));
    }
}

/// Settles a request: all its parts are there, or one cannot be had. One that nobody wants any more is cancelled late;
/// what has come is held as long as there is room.
void Pager::State::finish(JobPtr job) {
    release(*job);
    const TilePart* bad = job->lostPart();
    if (ahead.busy.erase(job->key) > 0) {
        finishAhead(*job);
    } else if (bad != nullptr) {
        if (!mayHeal) lost.insert(bad->key);
        fail(job->key, mayHeal ? Loss::damaged : Loss::forGood,
             describe(job->key) + " could not be had: " + describe(bad->key) + " was read twice: " + bad->trouble);
    } else if (!job->unreachable.empty()) {
        fail(job->key, Loss::unreachable, describe(job->key) + " cannot be had for now: " + job->unreachable);
    } else {
        deliver(loadedTile(job->key, job->parts.back().tile, job->imageryChain));
    }
    dropUntaken();
    reader.wake();
    if (isSettled()) settled.notify_all();
}

/// What has been read goes to the workers; a job that was cancelled is settled, or read on if it is wanted again.
void Pager::State::handOver(std::vector<JobPtr> jobs) {
    for (JobPtr& job : jobs) {
        const bool hopeless = job->lostPart() != nullptr || !job->unreachable.empty();
        const bool partly =
            std::any_of(job->parts.begin(), job->parts.end(), [](const TilePart& part) { return part.toBeRead(); });
        if (hopeless || !partly) {
            toDecode.push_back(std::move(job));
            decodeWork.notify_one();
        } else if (wanted.contains(job->key)) {
            toRead.push_back(std::move(job));
        } else {
            release(*job);
            ++(ahead.busy.erase(job->key) > 0 ? count.prefetch.cancelled : count.cancelled);
            if (isSettled()) settled.notify_all();
        }
    }
}

void Pager::State::readLoop() {
    std::unique_lock lock(mutex);
    while (!stopping) {
        if (options.cancelReads) handOver(reader.cancelUnless(worthReading()));
        JobPtr job = nextJob();
        const bool idle = job == nullptr;
        lock.unlock();
        if (job) reader.begin(std::move(job));
        std::vector<JobPtr> ended = reader.wait(idle);
        lock.lock();
        count.bytesRead = reader.payloadBytes();
        count.reads = reader.statistics();
        handOver(std::move(ended));
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
        const bool complete = job->decode();
        const bool hopeless = job->lostPart() != nullptr || !job->unreachable.empty();
        lock.lock();
        if (complete || hopeless) {
            finish(std::move(job));
        } else {
            toRead.push_back(std::move(job));
            reader.wake();
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
    state_->reader.wake();
    state_->decodeWork.notify_all();
    for (std::thread& thread : state_->threads) thread.join();
}

void Pager::want(const std::vector<TileRequest>& wanted, const std::vector<TileRequest>& ahead) {
    const std::lock_guard lock(state_->mutex);
    TileKeySet before(state_->queue.begin(), state_->queue.end());
    state_->queue.clear();
    state_->wanted.clear();
    for (const TileRequest& request : wanted) {
        const TileKey key{request.layer, request.id};
        if (state_->wanted.insert(key).second) state_->accept(key, before.erase(key) > 0);
    }
    state_->count.cancelled += before.size();
    state_->ahead.queue.clear();
    state_->ahead.wanted.clear();
    for (const TileRequest& request : ahead) state_->acceptAhead({request.layer, request.id});
    state_->dropUntaken();
    state_->reader.wake();
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

std::vector<LoadedTile> Pager::takeAhead() {
    const std::lock_guard lock(state_->mutex);
    return std::exchange(state_->ahead.arrived, {});
}

void Pager::waitUntilSettled() {
    std::unique_lock lock(state_->mutex);
    state_->settled.wait(lock, [this] { return state_->isSettled(); });
}

PagerStatistics Pager::statistics() const {
    const std::lock_guard lock(state_->mutex);
    PagerStatistics now = state_->count;
    now.hostBytes = state_->cache.bytes();
    now.comingBytes = state_->reserved;
    now.untaken = state_->loaded.size();
    return now;
}

}  // namespace terray
