#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "common/version.h"
#include "server/serve_command.h"

namespace {

int exitWith(terray::ExitCode code, const char* message) {
    std::fprintf(stderr, "terray-server: %s\n", message);
    return static_cast<int>(code);
}

}  // namespace

int main(int count, char** values) {
    const std::vector<std::string> arguments(values + 1, values + count);
    if (arguments == std::vector<std::string>{"--version"}) {
        const terray::BuildInfo& info = terray::buildInfo();
        std::printf("terray-server %s, commit %s%s\n", std::string(info.version).c_str(),
                    std::string(info.commit).c_str(), info.dirty ? " with changes" : "");
        return static_cast<int>(terray::ExitCode::ok);
    }
    try {
        return static_cast<int>(terray::server::runServer(arguments));
    } catch (const terray::Error& error) {
        return exitWith(error.code(), error.what());
    } catch (const std::exception& error) {
        return exitWith(terray::ExitCode::internal, error.what());
    }
}
