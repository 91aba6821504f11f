#pragma once

#include <string>
#include <vector>

namespace terray {

/// Names as a user gave them, each "@list.txt" replaced by the names in that file: one a line, taken as if they stood
/// on the command line; empty lines and such that begin with # say nothing.
///
/// Throws Error(input) when a list cannot be read, is empty, or names another list.
[[nodiscard]] std::vector<std::string> withoutLists(const std::vector<std::string>& names);

}  // namespace terray
