#pragma once

#include <functional>
#include <string>

namespace terray::bench {

/// Seconds of this thread's processor time that `work` takes: the least of as many runs as fit into half a second, two
/// at the least.
[[nodiscard]] double leastSeconds(const std::function<void()>& work);

/// A benchmark's main: calls `measure` for each argument NAME=FILE. What it throws is told on stderr under the
/// program's name.
/// @return the program's exit code
[[nodiscard]] int measureFiles(const std::string& program, int count, char** arguments,
                               const std::function<void(const std::string& name, const std::string& file)>& measure);

}  // namespace terray::bench
