#pragma once

#include <string>
#include <vector>

#include "common/view.h"
#include "tests/bench/embree_rates/ground.h"

namespace terray {

struct NamedView {
    std::string name;
    View view;
};

/// The four views of the benchmark, placed by rule so that they fit any ground: straight down from above the middle;
/// obliquely from a fifth of the way in; over the map to the horizon from a corner; along a ridge from its summit.
[[nodiscard]] std::vector<NamedView> benchmarkViews(const Ground& ground, int width, int height);

}  // namespace terray
