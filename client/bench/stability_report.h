#pragma once

#include <string>
#include <vector>

#include "client/bench/stability.h"
#include "common/json.h"

namespace terray {

/// Rows for people, a line each under a heading.
[[nodiscard]] std::string stabilityHeading();
[[nodiscard]] std::string lineOf(const StabilityRow& row);
/// stability.csv: documented in client/README.md, "Stability".
[[nodiscard]] std::string stabilityTable(const std::vector<StabilityRow>& rows);
[[nodiscard]] Json toJson(const StabilityRow& row);

}  // namespace terray
