#include "client/engine/program.h"

#include <csignal>
#include <cstdio>
#include <exception>

#include "common/version.h"

namespace terray {
namespace {

volatile std::sig_atomic_t interrupted = 0;

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

void catchInterrupts() {
    const auto note = [](int) { interrupted = 1; };
    std::signal(SIGINT, note);
    std::signal(SIGTERM, note);
}

void throwIfInterrupted() {
    if (interrupted != 0) throw Error(ExitCode::interrupted, "interrupted");
}

}  // namespace terray
