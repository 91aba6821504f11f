#pragma once

#include <chrono>
#include <cstddef>

namespace terray {

/// A line on stderr that says how far a run is and how long it will still take; nothing when stderr is no terminal. The
/// line is erased when the bar goes out of scope.
class ProgressBar {
  public:
    /// @param before  of the frames, those that an earlier run has done
    explicit ProgressBar(size_t frames, size_t before = 0);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// So many frames are done, those before counted in. Draws at most ten times a second.
    void show(size_t done);

  private:
    using Clock = std::chrono::steady_clock;
    size_t frames_;
    size_t before_;
    bool onTerminal_;
    Clock::time_point start_;
    Clock::time_point lastShown_;
};

}  // namespace terray
