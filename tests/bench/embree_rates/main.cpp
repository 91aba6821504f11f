// embree_rates: the packet march against Embree 3 on the same map, views and threads, in one run.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "common/command_line.h"
#include "common/error.h"
#include "common/version.h"
#include "tests/bench/embree_rates/report.h"

namespace terray {
namespace {

// Samples along a side: for views that have something to look at, and of Embree's widest grid.
constexpr int64_t kFewestSamples = 64;
constexpr int64_t kMostSamples = 32767;

struct Options {
    int64_t size = 4096;
    int64_t seed = 1;
    std::string heights;
    int64_t columns = 0;
    double spacing = 1;
    int width = 1280;
    int height = 720;
    int64_t threads = 2;
    int64_t runs = 7;
    std::string depths;
};

/// @return false when only help was asked for
bool parse(const std::vector<std::string>& arguments, Options& options) {
    CommandLine line("embree_rates", "Casts one map's views with the packet march and with Embree 3; prints tables.");
    line.option("--size", options.size, "N", "samples along a side of the synthetic map");
    line.option("--seed", options.seed, "N", "of the synthetic map");
    line.option("--heights", options.heights, "FILE", "a map of row-major float32 metres instead");
    line.option("--columns", options.columns, "N", "samples in a row of FILE");
    line.option("--spacing", options.spacing, "METRES", "between the samples of FILE");
    line.size("--picture", options.width, options.height, "size of the pictures");
    line.option("--threads", options.threads, "N", "that cast, and build for Embree");
    line.option("--runs", options.runs, "N", "that are measured");
    line.option("--depths", options.depths, "FOLDER",
                "also write each view's depths there: VIEW-march.f32, VIEW-embree.f32");
    if (!line.parse(arguments)) return false;
    if (!options.heights.empty() && options.columns < 3)
        throw Error(ExitCode::usage, "--heights needs --columns, 3 or more");
    if (options.heights.empty() && (options.size < kFewestSamples || options.size > kMostSamples))
        throw Error(ExitCode::usage, "--size is 64 to 32767 (Embree's widest grid)");
    if (options.threads < 1 || options.runs < 1) throw Error(ExitCode::usage, "--threads and --runs are 1 or more");
    return true;
}

Footprint pyramidFootprint(const Ground& ground, int64_t runs) {
    std::vector<double> seconds;
    Footprint footprint{.name = "maximum mipmap, one thread"};
    for (int64_t run = 0; run < runs; ++run) {
        const auto begin = std::chrono::steady_clock::now();
        const HeightPyramid pyramid(ground.codes.view());
        seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
        footprint.bytes = static_cast<int64_t>(pyramid.maximaBytes());
        footprint.dataBytes = static_cast<int64_t>(pyramid.sampleBytes());
    }
    footprint.buildSeconds = spreadOf(std::move(seconds));
    return footprint;
}

Footprint meshFootprint(const Ground& ground, const Options& options) {
    std::vector<double> seconds;
    Footprint footprint{.name = "Embree's BVH over one grid, " + std::to_string(options.threads) + " threads"};
    for (int64_t run = 0; run < options.runs; ++run) {
        const EmbreeMesh mesh(ground, {.threads = static_cast<int>(options.threads)});
        seconds.push_back(mesh.buildSeconds());
        footprint.bytes = mesh.bytes();
        footprint.dataBytes = mesh.vertexBytes();
    }
    footprint.buildSeconds = spreadOf(std::move(seconds));
    return footprint;
}

void writeDepths(const std::string& folder, const std::string& name, const Grid<float>& depths) {
    std::ofstream out(folder + "/" + name + ".f32", std::ios::binary);
    const auto cells = depths.cells();
    out.write(reinterpret_cast<const char*>(cells.data()), static_cast<std::streamsize>(cells.size_bytes()));
    if (!out.flush()) throw Error(ExitCode::output, "cannot write depths of " + name + " to \"" + folder + "\"");
}

int64_t countHoles(const Grid<float>& march, const Grid<float>& robust, const Grid<float>& fastest) {
    int64_t holes = 0;
    for (size_t i = 0; i < march.cells().size(); ++i)
        holes += std::isinf(fastest.cells()[i]) && std::isfinite(march.cells()[i]) && std::isfinite(robust.cells()[i]);
    return holes;
}

/// One view's pictures against each other and against brute force. casters: those of the view.
ViewAgreement compare(const Ground& ground, const NamedView& view, const std::vector<Caster>& casters,
                      const Caster& robust, const Options& options) {
    constexpr int64_t kTruthRays = 2000;
    const auto cast = [&](const Caster& caster) {
        Grid<float> depths({view.view.width, view.view.height});
        castFrame(caster, view.view, static_cast<int>(options.threads), depths.view());
        return depths;
    };
    const Grid<float> march = cast(casters[kMarch]);
    const Grid<float> mesh = cast(robust);
    if (!options.depths.empty()) {
        writeDepths(options.depths, view.name + "-march", march);
        writeDepths(options.depths, view.name + "-embree", mesh);
    }
    return {.surfaces = compareDepths(ground, view.view, march.view(), mesh.view()),
            .marchTruth = compareWithTruth(ground, view.view, march.view(), kTruthRays),
            .meshTruth = compareWithTruth(ground, view.view, mesh.view(), kTruthRays),
            .holes = countHoles(march, mesh, cast(casters[kEmbreeEight]))};
}

void printSetting(const Ground& ground, const Options& options) {
    const BuildInfo& build = buildInfo();
    std::printf("embree_rates: commit %s%s, %s, %s; Embree %s; kernel %s\n", std::string(build.commit).c_str(),
                build.dirty ? " with changes" : "", std::string(build.compiler).c_str(),
                std::string(build.build).c_str(), RTC_VERSION_STRING, bestKernel().name);
    std::printf(
        "map: %s, %lld x %lld samples of %g m, heights %.1f .. %.1f m in steps of %g m; %dx%d pixels, %lld threads\n",
        ground.name.c_str(), static_cast<long long>(ground.codes.width()),
        static_cast<long long>(ground.codes.height()), ground.spacing, ground.bottom,
        ground.bottom + ground.quantum * std::ranges::max(ground.codes.cells()), ground.quantum, options.width,
        options.height, static_cast<long long>(options.threads));
}

void run(const Options& options) {
    const auto threads = static_cast<int>(options.threads);
    const Ground ground = options.heights.empty() ? syntheticGround(options.size, static_cast<uint64_t>(options.seed))
                                                  : groundFromFile(options.heights, options.columns, options.spacing);
    const GridSize samples = ground.codes.size();
    if (std::min(samples.width, samples.height) < kFewestSamples ||
        std::max(samples.width, samples.height) > kMostSamples)
        throw Error(ExitCode::input, "the map has " + std::to_string(samples.width) + " x " +
                                         std::to_string(samples.height) + " samples; expected 64 to 32767 each way");
    printSetting(ground, options);
    printFootprints({pyramidFootprint(ground, options.runs), meshFootprint(ground, options)});

    const HeightPyramid pyramid(ground.codes.view());
    const auto meshes = embreeMeshes(ground, threads);
    const auto views = benchmarkViews(ground, options.width, options.height);
    std::vector<std::vector<Caster>> casters;
    for (const NamedView& view : views)
        casters.push_back({fastestEmbree(meshes, view.view, 8, threads).caster(),
                           fastestEmbree(meshes, view.view, 0, threads).caster(),
                           marchCaster(bestKernel(), ground, pyramid, true),
                           marchCaster(bestKernel(), ground, pyramid, false),
                           marchCaster(portableKernel(), ground, pyramid, true), scalarCaster(ground, pyramid)});
    printRates(views, casters, measureRates(casters, views, static_cast<int>(options.runs), threads));

    std::vector<StepCounts> steps;
    std::vector<ViewAgreement> agreements;
    for (size_t v = 0; v < views.size(); ++v) {
        steps.push_back(countSteps(bestKernel(), ground, pyramid, views[v].view));
        agreements.push_back(compare(ground, views[v], casters[v], robustEmbree(meshes).caster(), options));
    }
    printSteps(views, steps);
    printAgreement(views, agreements);
}

}  // namespace
}  // namespace terray

int main(int argc, char** argv) {
    try {
        terray::Options options;
        if (terray::parse(std::vector<std::string>(argv + 1, argv + argc), options)) terray::run(options);
        return static_cast<int>(terray::ExitCode::ok);
    } catch (const terray::Error& error) {
        std::fprintf(stderr, "embree_rates: %s\n", error.what());
        return static_cast<int>(error.code());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "embree_rates: internal error: %s\n", error.what());
        return static_cast<int>(terray::ExitCode::internal);
    }
}
