#include "tests/bench/codec_rates/rates.h"

#include <algorithm>
#include <ctime>
#include <limits>

namespace terray::bench {
namespace {

double threadSeconds() {
    timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

double leastSeconds(const std::function<void()>& work) {
    constexpr double kEnough = 0.5;
    double least = std::numeric_limits<double>::infinity();
    double spent = 0;
    for (int run = 0; run < 2 || spent < kEnough; ++run) {
        const double start = threadSeconds();
        work();
        const double seconds = threadSeconds() - start;
        least = std::min(least, seconds);
        spent += seconds;
    }
    return least;
}

}  // namespace terray::bench
