#include "common/parallel.h"

#include <algorithm>
#include <exception>
#include <limits>
#include <mutex>
#include <thread>
#include <vector>

#include "common/check.h"
#include "common/error.h"

namespace terray {
namespace {

/// The failure that is reported: that of the lowest item, whatever the order in which threads met theirs.
class FirstFailure {
  public:
    void record(size_t item) {
        const std::scoped_lock lock(mutex_);
        if (item >= item_) return;
        item_ = item;
        exception_ = std::current_exception();
        any_ = true;
    }
    [[nodiscard]] bool any() const { return any_; }
    void rethrow() const {
        if (exception_) std::rethrow_exception(exception_);
    }

  private:
    std::mutex mutex_;
    std::atomic<bool> any_ = false;
    size_t item_ = std::numeric_limits<size_t>::max();
    std::exception_ptr exception_;
};

}  // namespace

void forEachParallel(const std::function<std::optional<size_t>()>& next, int jobs, const std::atomic<bool>& stop,
                     const std::function<void(int worker, size_t item)>& work) {
    TERRAY_CHECK_OP(jobs, >=, 1);
    FirstFailure failure;
    const auto run = [&](int worker) {
        while (!stop && !failure.any()) {
            size_t item = 0;  // no item yet: a failure to get one is reported before those of the items
            try {
                const std::optional<size_t> given = next();
                if (!given) return;
                item = *given;
                work(worker, item);
            } catch (...) {
                failure.record(item);
            }
        }
    };

    // The caller is worker 0, so that one job needs no thread at all.
    {
        std::vector<std::jthread> threads;
        for (int worker = 1; worker < jobs; ++worker) threads.emplace_back(run, worker);
        run(0);
    }
    throwIfStopped(stop);
    failure.rethrow();
}

void forEachParallel(size_t count, int jobs, const std::atomic<bool>& stop,
                     const std::function<void(int worker, size_t item)>& work) {
    TERRAY_CHECK_OP(jobs, >=, 1);
    std::atomic<size_t> given = 0;
    const auto next = [&]() -> std::optional<size_t> {
        const size_t item = given++;
        return item < count ? std::optional(item) : std::nullopt;
    };
    const auto useful = std::min<size_t>(static_cast<size_t>(jobs), std::max<size_t>(count, 1));
    forEachParallel(next, static_cast<int>(useful), stop, work);
}

void throwIfStopped(const std::atomic<bool>& stop) {
    if (stop) throw Error(ExitCode::interrupted, "interrupted");
}

}  // namespace terray
