#pragma once

#include <string>
#include <vector>

#include "common/error.h"

namespace terray {

/// The program terray-view without its name: flies over a dataset in a window, or with `--headless` draws one
/// picture of it and writes it as PNG or EXR.
/// Throws Error as README's table of exit codes says; a picture for which a tile could not be read is not written.
/// Needs no current GL context: it makes its own.
ExitCode runView(const std::vector<std::string>& arguments);

}  // namespace terray
