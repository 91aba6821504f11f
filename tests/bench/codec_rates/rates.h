#pragma once

#include <functional>

namespace terray::bench {

/// Seconds of this thread's processor time that `work` takes: the least of as many runs as fit into half a second, two
/// at the least.
[[nodiscard]] double leastSeconds(const std::function<void()>& work);

}  // namespace terray::bench
