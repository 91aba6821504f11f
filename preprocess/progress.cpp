#include "preprocess/progress.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <numeric>
#include <string>

#include <unistd.h>

namespace terray {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// What every style needs to know of the running stage.
struct Stage {
    std::string name;
    uint64_t blocks = 0;
    uint64_t done = 0;
    uint64_t doneBefore = 0;  ///< by an earlier run
    Clock::time_point start = Clock::now();

    Stage() = default;
    Stage(std::string stageName, uint64_t stageBlocks, uint64_t stageDone)
        : name(std::move(stageName)), blocks(stageBlocks), done(stageDone), doneBefore(stageDone) {}

    /// Seconds that the rest of it will take if it goes on as so far; 0 before the first block.
    [[nodiscard]] double secondsLeft() const {
        if (done == doneBefore) return 0;
        return secondsSince(start) / static_cast<double>(done - doneBefore) * static_cast<double>(blocks - done);
    }
};

/// One line for each stage and note, for logs.
class LineObserver final : public BuildObserver {
  public:
    void note(const std::string& text) override { std::fprintf(stderr, "note: %s\n", text.c_str()); }
    void stageBegins(const std::string& name, uint64_t blocks, uint64_t done) override {
        stage_ = Stage(name, blocks, done);
        if (done > 0)
            std::fprintf(stderr, "%s: %llu of %llu blocks were done before\n", name.c_str(),
                         static_cast<unsigned long long>(done), static_cast<unsigned long long>(blocks));
    }
    void blockDone(uint64_t tiles, uint64_t bytes) override {
        if (++stage_.done < stage_.blocks) return;
        std::fprintf(stderr, "%s: %llu blocks in %.1f s; %llu tiles, %s so far\n", stage_.name.c_str(),
                     static_cast<unsigned long long>(stage_.blocks), secondsSince(stage_.start),
                     static_cast<unsigned long long>(tiles), readableBytes(bytes).c_str());
    }

  private:
    Stage stage_;
};

/// A bar with rate and time left, redrawn in place at most ten times a second.
class BarObserver final : public BuildObserver {
  public:
    void note(const std::string& text) override {
        std::fprintf(stderr, "\r\033[Knote: %s\n", text.c_str());
        if (stage_.blocks > 0) draw(0);
    }
    void stageBegins(const std::string& name, uint64_t blocks, uint64_t done) override {
        if (stage_.blocks > 0) std::fputc('\n', stderr);
        stage_ = Stage(name, blocks, done);
        draw(0);
    }
    void blockDone(uint64_t tiles, uint64_t) override {
        ++stage_.done;
        if (stage_.done < stage_.blocks && secondsSince(drawn_) < 0.1) return;
        draw(tiles);
    }
    void end() override {
        if (stage_.blocks > 0) std::fputc('\n', stderr);
        stage_ = {};
    }

  private:
    void draw(uint64_t tiles) {
        constexpr uint64_t kWidth = 30;
        drawn_ = Clock::now();
        const auto filled = static_cast<size_t>(stage_.done * kWidth / stage_.blocks);
        const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
        const double seconds = std::max(secondsSince(start_), 1e-3);
        std::fprintf(stderr, "\r\033[K%-24s [%s] %llu/%llu blocks  %.0f tiles/s  %.0f s left", stage_.name.c_str(),
                     bar.c_str(), static_cast<unsigned long long>(stage_.done),
                     static_cast<unsigned long long>(stage_.blocks), static_cast<double>(tiles) / seconds,
                     stage_.secondsLeft());
        std::fflush(stderr);
    }

    Stage stage_;
    Clock::time_point start_ = Clock::now();
    Clock::time_point drawn_;
};

/// One JSON object for each line on stdout.
class JsonObserver final : public BuildObserver {
  public:
    void note(const std::string& text) override { print(Json::Object{{"event", "note"}, {"text", text}}); }
    void stageBegins(const std::string& name, uint64_t blocks, uint64_t done) override {
        stage_ = Stage(name, blocks, done);
        print(Json::Object{{"event", "stage"}, {"stage", name}, {"blocks", blocks}, {"doneBefore", done}});
    }
    void blockDone(uint64_t tiles, uint64_t bytes) override {
        ++stage_.done;
        print(Json::Object{{"event", "progress"},
                           {"stage", stage_.name},
                           {"done", stage_.done},
                           {"blocks", stage_.blocks},
                           {"tiles", tiles},
                           {"bytes", bytes},
                           {"seconds", secondsSince(start_)},
                           {"secondsLeft", stage_.secondsLeft()}});
    }

    static void print(const Json& json) {
        std::printf("%s\n", json.dump(0).c_str());
        std::fflush(stdout);
    }

  private:
    Stage stage_;
    Clock::time_point start_ = Clock::now();
};

void printJsonSummary(const BuildSummary& summary) {
    Json::Object steps;
    for (size_t step = 0; step < kBuildStepNames.size(); ++step)
        steps.emplace_back(kBuildStepNames[step], summary.stepSeconds[step]);
    Json::Array errors;
    for (const double error : summary.metadata.levelErrors) errors.emplace_back(error);
    JsonObserver::print(Json::Object{{"event", "done"},
                                     {"heightTiles", summary.metadata.heightTiles},
                                     {"heightBytes", summary.heightBytes},
                                     {"imageryTiles", summary.metadata.imageryTiles},
                                     {"imageryBytes", summary.imageryBytes},
                                     {"processes", summary.processes},
                                     {"jobs", summary.jobs},
                                     {"seconds", summary.seconds},
                                     {"stepSeconds", steps},
                                     {"levelErrors", errors}});
}

/// A table of the steps, so that a user sees what bounds the run.
void printSteps(const BuildSummary& summary) {
    const double all = std::accumulate(summary.stepSeconds.begin(), summary.stepSeconds.end(), 0.0);
    const std::string processes =
        summary.processes > 1 ? std::to_string(summary.processes) + " processes of " : std::string();
    std::printf("time: %.2f s on %s%d jobs; of all threads:\n", summary.seconds, processes.c_str(), summary.jobs);
    for (size_t step = 0; step < kBuildStepNames.size(); ++step)
        std::printf("  %-7s %9.2f s %4.0f %%\n", kBuildStepNames[step], summary.stepSeconds[step],
                    100 * summary.stepSeconds[step] / std::max(all, 1e-9));
}

void printTextSummary(const BuildSummary& summary) {
    const DatasetMetadata& metadata = summary.metadata;
    std::printf("heights: %llu tiles, %s; %lld x %lld samples of %s m, %s to %s m, %llu holes\n",
                static_cast<unsigned long long>(metadata.heightTiles), readableBytes(summary.heightBytes).c_str(),
                static_cast<long long>(metadata.samples.width), static_cast<long long>(metadata.samples.height),
                readableNumber(metadata.tiling.finestSpacing).c_str(), readableNumber(metadata.minHeight).c_str(),
                readableNumber(metadata.maxHeight).c_str(), static_cast<unsigned long long>(metadata.holeSamples));
    if (metadata.imageryLevel)
        std::printf("imagery: %llu tiles, %s; texels of %s m\n", static_cast<unsigned long long>(metadata.imageryTiles),
                    readableBytes(summary.imageryBytes).c_str(),
                    readableNumber(metadata.tiling.spacing(*metadata.imageryLevel)).c_str());
    std::printf("heights are off by at most %s m, measured; bound %s m\n",
                readableNumber(metadata.levelErrors.back()).c_str(), readableNumber(metadata.errorBound).c_str());
    printSteps(summary);
    std::printf("error by level, m:");
    for (const double error : metadata.levelErrors) std::printf(" %s", readableNumber(error).c_str());
    std::printf("\n");
}

}  // namespace

std::unique_ptr<BuildObserver> makeObserver(ProgressStyle style) {
    if (style == ProgressStyle::silent) return std::make_unique<SilentObserver>();
    if (style == ProgressStyle::json) return std::make_unique<JsonObserver>();
    if (::isatty(STDERR_FILENO) != 0) return std::make_unique<BarObserver>();
    return std::make_unique<LineObserver>();
}

void printSummary(const BuildSummary& summary, ProgressStyle style) {
    if (style == ProgressStyle::json) printJsonSummary(summary);
    if (style == ProgressStyle::automatic) printTextSummary(summary);
}

std::string readableBytes(uint64_t bytes) {
    constexpr std::array kUnits = {"B", "kB", "MB", "GB", "TB", "PB"};
    auto amount = static_cast<double>(bytes);
    size_t unit = 0;
    for (; amount >= 1000 && unit + 1 < kUnits.size(); ++unit) amount /= 1000;
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), unit == 0 ? "%.0f %s" : "%.2f %s", amount, kUnits[unit]);
    return text.data();
}

std::string readableNumber(double number) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.6g", number);
    return text.data();
}

}  // namespace terray
