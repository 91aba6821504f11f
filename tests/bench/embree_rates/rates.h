#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/grid.h"
#include "tests/bench/embree_rates/views.h"

namespace terray {

/// Casts one tile of a picture into its part of the depths. Called from many threads.
using TileCaster = std::function<void(int tile, GridView<float> depths)>;

/// One of the rivals.
struct Caster {
    std::string name;
    std::function<TileCaster(const View& view)> aim;
};

/// Seconds of one frame: on the clock, and of all threads together on their cores. Where other programs take cores away
/// the former grows and the latter hardly does.
struct FrameTime {
    double wall;
    double cpu;
};

/// Casts all tiles of a view's picture, which the threads take in turn, row by row.
FrameTime castFrame(const Caster& caster, const View& view, int threads, GridView<float> depths);

struct Spread {
    double median;
    double least;
    double most;
};
/// Of at least one value.
[[nodiscard]] Spread spreadOf(std::vector<double> values);

/// What one caster did with one view in all runs.
struct Series {
    std::vector<FrameTime> frames;
    double rays = 0;  ///< of a frame
    int threads = 1;

    [[nodiscard]] Spread wallRate() const;  ///< Mray/s
    [[nodiscard]] Spread cpuRate() const;   ///< Mray/s that the threads would reach on cores of their own
};

/// Medians over the runs of how many times as fast `a` was as `b` in the same run.
struct Ratio {
    double wall;
    double cpu;
};
[[nodiscard]] Ratio ratio(const Series& a, const Series& b);

/// Runs all casters over all views, `runs` times, in turn within each run. Of the two frames of each turn the second
/// counts, so that all find their own data in the caches, as when frame follows frame. A first round is not counted.
/// casters[v]: those of view v. @return  as casters
[[nodiscard]] std::vector<std::vector<Series>> measureRates(const std::vector<std::vector<Caster>>& casters,
                                                            const std::vector<NamedView>& views, int runs, int threads);

}  // namespace terray
