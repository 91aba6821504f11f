#include "client/bench/progress_bar.h"

#include <cstdio>
#include <string>

#include <unistd.h>

namespace terray {

ProgressBar::ProgressBar(size_t frames, size_t before)
    : frames_(frames),
      before_(before),
      onTerminal_(isatty(STDERR_FILENO) != 0),
      start_(Clock::now()),
      lastShown_(start_) {}

ProgressBar::~ProgressBar() {
    if (onTerminal_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::show(size_t done) {
    constexpr size_t kCells = 30;
    const Clock::time_point now = Clock::now();
    if (!onTerminal_ || (done < frames_ && now - lastShown_ < std::chrono::milliseconds(100))) return;
    lastShown_ = now;
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    const double rate = static_cast<double>(done - before_) / elapsed;
    const double remaining = static_cast<double>(frames_ - done) / rate;
    const size_t filled = kCells * done / frames_;
    const std::string bar = std::string(filled, '#') + std::string(kCells - filled, '.');
    const int seconds = static_cast<int>(remaining + 0.5);
    std::fprintf(stderr, "\r[%s] frame %zu of %zu, %.1f a second, %d:%02d left\033[K", bar.c_str(), done, frames_, rate,
                 seconds / 60, seconds % 60);
}

}  // namespace terray
