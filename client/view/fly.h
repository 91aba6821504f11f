#pragma once

#include <chrono>

#include "client/view/view_options.h"
#include "common/error.h"

namespace terray {

/// Opens the window of terray-view and flies until it is closed; remembers settings in configFolder(). Throws Error as
/// Viewer does, Error(unsupported) in a build without a window.
/// @param arguments  those that `options` were parsed from  @param started  of the program
ExitCode fly(const ViewOptions& options, const Arguments& arguments, std::chrono::steady_clock::time_point started);

}  // namespace terray
