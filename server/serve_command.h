#pragma once

#include <string>
#include <vector>

#include "common/error.h"

namespace terray::server {

/// Runs terray-server as if called with `arguments` (without the program's name), until SIGTERM or SIGINT; SIGHUP
/// reloads the datasets. Called once, from the only thread that there is.
/// Throws Error, which is for main to print.
[[nodiscard]] ExitCode runServer(const std::vector<std::string>& arguments);

}  // namespace terray::server
