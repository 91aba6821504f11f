#include "tests/bench/embree_rates/rates.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>

#include "common/check.h"
#include "common/parallel.h"
#include "tests/bench/packet_march/packet_march.h"

namespace terray {
namespace {

double wallSeconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double cpuSeconds() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// The spread of some value of each frame.
template <class Value>
Spread overFrames(const std::vector<FrameTime>& frames, Value value) {
    std::vector<double> values;
    for (const FrameTime& frame : frames) values.push_back(value(frame));
    return spreadOf(std::move(values));
}

}  // namespace

FrameTime castFrame(const Caster& caster, const View& view, int threads, GridView<float> depths) {
    const TileCaster cast = caster.aim(view);
    const auto tiles = static_cast<size_t>(tileCount(pictureRays(view, {})));
    const std::atomic<bool> stop = false;
    const double wall = wallSeconds();
    const double cpu = cpuSeconds();
    forEachParallel(tiles, threads, stop, [&](int, size_t tile) { cast(static_cast<int>(tile), depths); });
    return {wallSeconds() - wall, cpuSeconds() - cpu};
}

Spread spreadOf(std::vector<double> values) {
    TERRAY_CHECK(!values.empty());
    std::ranges::sort(values);
    const size_t half = values.size() / 2;
    const double median = values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
    return {median, values.front(), values.back()};
}

Spread Series::wallRate() const {
    return overFrames(frames, [&](const FrameTime& frame) { return 1e-6 * rays / frame.wall; });
}

Spread Series::cpuRate() const {
    return overFrames(frames, [&](const FrameTime& frame) { return 1e-6 * rays * threads / frame.cpu; });
}

Ratio ratio(const Series& a, const Series& b) {
    TERRAY_CHECK_OP(a.frames.size(), ==, b.frames.size());
    std::vector<double> wall;
    std::vector<double> cpu;
    for (size_t i = 0; i < a.frames.size(); ++i) {
        wall.push_back(b.frames[i].wall / a.frames[i].wall);
        cpu.push_back(b.frames[i].cpu / a.frames[i].cpu);
    }
    return {spreadOf(std::move(wall)).median, spreadOf(std::move(cpu)).median};
}

std::vector<std::vector<Series>> measureRates(const std::vector<std::vector<Caster>>& casters,
                                              const std::vector<NamedView>& views, int runs, int threads) {
    std::vector<std::vector<Series>> series(views.size());
    for (int run = -1; run < runs; ++run)
        for (size_t v = 0; v < views.size(); ++v) {
            const View& view = views[v].view;
            Grid<float> depths({view.width, view.height});
            const auto rays = static_cast<double>(depths.size().count());
            series[v].resize(casters[v].size(), {.rays = rays, .threads = threads});
            for (size_t c = 0; c < casters[v].size(); ++c) {
                castFrame(casters[v][c], view, threads, depths.view());  // the rival before has emptied the caches
                const FrameTime frame = castFrame(casters[v][c], view, threads, depths.view());
                if (run >= 0) series[v][c].frames.push_back(frame);
            }
        }
    return series;
}

}  // namespace terray
