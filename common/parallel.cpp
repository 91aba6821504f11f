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

void forEachParallel(size_t count, int jobs, const std::atomic<bool>& stop,
                     const std::function<void(int worker, size_t item)>& work) {
    TERRAY_CHECK_OP(jobs, >=, 1);
    std::atomic<size_t> next = 0;
    FirstFailure failure;
    const auto run = [&](int worker) {
        while (!stop && !failure.any()) {
            const size_t item = next++;
            if (item >= count) return;
            try {
                work(worker, item);
            } catch (...) {
                failure.record(item);
            }
        }
    };

    // The caller is worker 0, so that one job needs no thread at all.
    {
        std::vector<std::jthread> threads;
        const auto useful = static_cast<int>(std::min<size_t>(static_cast<size_t>(jobs), std::max<size_t>(count, 1)));
        for (int worker = 1; worker < useful; ++worker) threads.emplace_back(run, worker);
        run(0);
    }
    throwIfStopped(stop);
    failure.rethrow();
}

void throwIfStopped(const std::atomic<bool>& stop) {
    if (stop) throw Error(ExitCode::interrupted, "interrupted");
}

}  // namespace terray
