#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>

namespace terray {

/// Runs work(worker, item) once for each item 0 .. count - 1 on `jobs` threads, which take items in ascending order.
///
/// worker is 0 .. jobs - 1, so that a thread can own a reader. Ends when all items are done, or after the first failure
/// or stop request: what was started is finished, nothing more begins. Then the exception of the lowest failed item is
/// thrown, or Error(interrupted) when `*stop` was set. Blocks the caller; jobs >= 1.
void forEachParallel(size_t count, int jobs, const std::atomic<bool>& stop,
                     const std::function<void(int worker, size_t item)>& work);

/// As above for the items that `next` gives out, in whatever order; no value: there are no more. All threads call it,
/// at any time; what it throws ends the work as a failure of `work` does.
void forEachParallel(const std::function<std::optional<size_t>()>& next, int jobs, const std::atomic<bool>& stop,
                     const std::function<void(int worker, size_t item)>& work);

/// Throws Error(interrupted) when a stop was asked for.
void throwIfStopped(const std::atomic<bool>& stop);

}  // namespace terray
