#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "common/error.h"
#include "preprocess/commands.h"
#include "preprocess/ranks.h"

namespace {

std::atomic<bool> stopRequested = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may touch only lock-free atomics");

extern "C" void requestStop(int) {
    stopRequested = true;
}

/// Ctrl-C ends the run in order; a file grown too large is an error of that write, not the end of the program.
void installSignals() {
    struct sigaction action = {};
    action.sa_handler = requestStop;
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    std::signal(SIGXFSZ, SIG_IGN);
}

int exitWith(terray::ExitCode code, const char* message) {
    std::fprintf(stderr, "terray-preprocess: %s\n", message);
    terray::endAllRanks(code);
    return static_cast<int>(code);
}

}  // namespace

int main(int count, char** values) {
    installSignals();
    try {
        return static_cast<int>(
            terray::runPreprocess(std::vector<std::string>(values + 1, values + count), stopRequested));
    } catch (const terray::Error& error) {
        return exitWith(error.code(), error.what());
    } catch (const std::bad_alloc&) {
        return exitWith(terray::ExitCode::internal, "out of memory; give a smaller --memory or fewer --jobs");
    } catch (const std::exception& error) {
        return exitWith(terray::ExitCode::internal, error.what());
    }
}
