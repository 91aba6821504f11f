#pragma once

#include <functional>

namespace terray {

/// One call to the operating system that changes the disk.
struct DiskCall {
    const char* name;     ///< "pwrite", "rename", ...
    int descriptor = -1;  ///< -1 for calls that name a path
};

/// Lets a test see every DiskCall of its own process before it happens, from any thread, and die there.
///
/// The test program defines pwrite() and its like itself, so that they come before the C library's.
class DiskWatch {
  public:
    /// @param dieNow  whether the process is to be killed (SIGKILL) now, a write when half of its bytes are out
    explicit DiskWatch(std::function<bool(const DiskCall&)> dieNow);
    ~DiskWatch();
    DiskWatch(const DiskWatch&) = delete;
    DiskWatch& operator=(const DiskWatch&) = delete;
};

}  // namespace terray
