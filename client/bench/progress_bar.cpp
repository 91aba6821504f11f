#include "client/bench/progress_bar.h"

#include <cstdio>
#include <string>

#include <unistd.h>

namespace terray {

ProgressBar::ProgressBar(size_t frames)
    : frames_(frames), onTerminal_(isatty(STDERR_FILENO) != 0), start_(Clock::now()), lastShown_(start_) {}

ProgressBar::~ProgressBar() {
    if (onTerminal_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::show(size_t done) {
    constexpr size_t kCells = 30;
    const Clock::time_point now = Clock::now();
    if (!onTerminal_ || (done < frames_ && now - lastShown_ < std::chrono::milliseconds(100))) return;
    lastShown_ = now;
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    const double remaining = elapsed / static_cast<double>(done) * static_cast<double>(frames_ - done);
    const size_t filled = kCells * done / frames_;
    const std::string bar = std::string(filled, '#') + std::string(kCells - filled, '.');
    const int seconds = static_cast<int>(remaining + 0.5);
    std::fprintf(stderr, "\r[%s] frame %zu of %zu, %.1f a second, %d:%02d left\033[K", bar.c_str(), done, frames_,
                 static_cast<double>(done) / elapsed, seconds / 60, seconds % 60);
}

}  // namespace terray
