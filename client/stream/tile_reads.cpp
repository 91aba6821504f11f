#include "client/stream/tile_reads.h"

#include <condition_variable>
#include <limits>
#include <mutex>
#include <utility>

namespace terray {
namespace {

class OneByOne final : public TileReads {
  public:
    explicit OneByOne(const TileSource& source) : source_(source) {}

    size_t atATime() const override { return std::numeric_limits<size_t>::max(); }
    bool mayHeal() const override { return false; }

    void begin(uint64_t ticket, TileLayer layer, const TileId& id, bool) override {
        done_.push_back({ticket, source_.read(layer, id)});
        if (done_.back().payload) count_.receivedBytes += done_.back().payload->size();
    }
    bool cancel(uint64_t) override { return false; }

    std::vector<TileRead> wait(bool block) override {
        if (block && done_.empty()) {
            std::unique_lock lock(mutex_);
            woken_.wait(lock, [this] { return wake_; });
            wake_ = false;
        }
        return std::exchange(done_, {});
    }
    void wake() override {
        {
            const std::lock_guard lock(mutex_);
            wake_ = true;
        }
        woken_.notify_one();
    }
    TileReadStatistics statistics() const override { return count_; }

  private:
    const TileSource& source_;
    std::vector<TileRead> done_;
    TileReadStatistics count_;
    std::mutex mutex_;
    std::condition_variable woken_;
    bool wake_ = false;
};

}  // namespace

std::unique_ptr<TileReads> readOneByOne(const TileSource& source) {
    return std::make_unique<OneByOne>(source);
}

}  // namespace terray
