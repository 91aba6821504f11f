#include "client/engine/program.h"

#include <csignal>
#include <cstdio>
#include <exception>

#include "common/version.h"

namespace terray {
namespace {

volatile std::sig_atomic_t interrupted = 0;

extern "C" void noteInterrupt(int) {
    interrupted = 1;
}

/// Ctrl-C ends the run in order, a second one at once; a file grown too large is an error of that write, not the end of
/// the program.
void installSignals() {
    struct sigaction action = {};
    action.sa_handler = noteInterrupt;
    action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    std::signal(SIGXFSZ, SIG_IGN);
}

void printVersion(const std::string& name) {
    const BuildInfo& info = buildInfo();
    const auto text = [](std::string_view view) { return std::string(view); };
    std::printf("%s %s, commit %s%s, %s, %s\n", name.c_str(), text(info.version).c_str(), text(info.commit).c_str(),
                info.dirty ? " with changes" : "", text(info.compiler).c_str(), text(info.build).c_str());
}

}  // namespace

int runProgram(const std::string& name, int argc, char** argv,
               const std::function<ExitCode(const std::vector<std::string>& arguments)>& body) {
    const std::vector<std::string> arguments(argv + 1, argv + argc);
    if (arguments == std::vector<std::string>{"--version"}) {
        printVersion(name);
        return static_cast<int>(ExitCode::ok);
    }
    installSignals();
    try {
        return static_cast<int>(body(arguments));
    } catch (const Error& error) {
        std::fprintf(stderr, "%s: %s\n", name.c_str(), error.what());
        return static_cast<int>(error.code());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s: internal error: %s\n", name.c_str(), error.what());
        return static_cast<int>(ExitCode::internal);
    }
}

void throwIfInterrupted() {
    if (interrupted != 0) throw Error(ExitCode::interrupted, "interrupted");
}

}  // namespace terray
