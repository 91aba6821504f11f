#pragma once

#include <cstddef>
#include <cstdint>

namespace terray::fuzz {

/// While one lives, its thread may hold at most so many bytes of operator new's beyond those that it held before; the
/// allocation that goes beyond stops the program, so that its stack says who asked. One at a time in a thread.
///
/// Programs with allocation_limit.cpp among their sources have operator new replaced. What C libraries take by malloc
/// is not counted: libFuzzer's -malloc_limit_mb bounds that.
class AllocationLimit {
  public:
    explicit AllocationLimit(size_t bytes);
    ~AllocationLimit();
    AllocationLimit(const AllocationLimit&) = delete;
    AllocationLimit& operator=(const AllocationLimit&) = delete;
};

/// What a function returns that was called under a limit.
template <class Function>
auto within(size_t bytes, Function function) {
    const AllocationLimit limit(bytes);
    return function();
}

}  // namespace terray::fuzz
