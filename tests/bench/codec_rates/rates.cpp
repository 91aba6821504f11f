#include "tests/bench/codec_rates/rates.h"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <limits>

#include "common/error.h"

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

int measureFiles(const std::string& program, int count, char** arguments,
                 const std::function<void(const std::string& name, const std::string& file)>& measure) {
    try {
        for (int n = 1; n < count; ++n) {
            const std::string argument = arguments[n];
            const size_t equals = argument.find('=');
            if (equals == std::string::npos)
                throw Error(ExitCode::usage, "expected NAME=FILE, found \"" + argument + "\"");
            measure(argument.substr(0, equals), argument.substr(equals + 1));
        }
    } catch (const Error& error) {
        std::fprintf(stderr, "%s: %s\n", program.c_str(), error.what());
        return static_cast<int>(error.code());
    }
    return 0;
}

}  // namespace terray::bench
