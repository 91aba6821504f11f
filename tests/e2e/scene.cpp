#include "tests/e2e/scene.h"

#include <atomic>

#include <gtest/gtest.h>
#include <unistd.h>

#include "preprocess/raster_files.h"

namespace terray {
namespace {

class FunctionReader final : public HeightReader {
  public:
    FunctionReader(const HeightFunction& heights, GridSize size) : heights_(heights), size_(size) {}
    void read(const GridRect& window, GridView<float> out) override {
        for (int64_t y = 0; y < window.height; ++y)
            for (int64_t x = 0; x < window.width; ++x) {
                const int64_t column = window.x + x;
                const int64_t row = window.y + y;
                const bool inside = column >= 0 && row >= 0 && column < size_.width && row < size_.height;
                out.at(x, y) = inside ? heights_(column, row) : kNoHeight;
            }
    }

  private:
    const HeightFunction& heights_;
    GridSize size_;
};

class FunctionHeights final : public HeightSource {
  public:
    FunctionHeights(HeightFunction heights, GridSize size, double spacing) : heights_(std::move(heights)) {
        info_.size = size;
        info_.west = 1000;
        info_.north = 5000;
        info_.spacing = spacing;
    }
    [[nodiscard]] const HeightGridInfo& info() const override { return info_; }
    [[nodiscard]] std::unique_ptr<HeightReader> openReader() const override {
        return std::make_unique<FunctionReader>(heights_, info_.size);
    }

  private:
    HeightFunction heights_;
    HeightGridInfo info_;
};

class FunctionColours final : public ColourReader {
  public:
    FunctionColours(const PhotoFunction& photo, const Tiling& tiling, uint32_t level)
        : photo_(photo), tiling_(tiling), level_(level) {}
    void read(const GridRect& window, GridView<Rgba> out) override {
        const double texel = tiling_.spacing(level_);
        for (int64_t y = 0; y < window.height; ++y)
            for (int64_t x = 0; x < window.width; ++x)
                out.at(x, y) = photo_(tiling_.west + (static_cast<double>(window.x + x) + 0.5) * texel,
                                      tiling_.north - (static_cast<double>(window.y + y) + 0.5) * texel);
    }

  private:
    const PhotoFunction& photo_;
    Tiling tiling_;
    uint32_t level_;
};

class FunctionPhoto final : public ColourSource {
  public:
    FunctionPhoto(PhotoFunction photo, const Tiling& tiling, GridSize samples, uint32_t level)
        : photo_(std::move(photo)), tiling_(tiling), samples_(samples), level_(level) {}
    [[nodiscard]] uint32_t level() const override { return level_; }
    [[nodiscard]] GroundRect bounds() const override {
        const double east = tiling_.west + static_cast<double>(samples_.width) * tiling_.finestSpacing;
        const double south = tiling_.north - static_cast<double>(samples_.height) * tiling_.finestSpacing;
        return {tiling_.west, south, east, tiling_.north};
    }
    [[nodiscard]] const std::vector<SourceFile>& files() const override { return files_; }
    [[nodiscard]] std::unique_ptr<ColourReader> openReader() const override {
        return std::make_unique<FunctionColours>(photo_, tiling_, level_);
    }

  private:
    PhotoFunction photo_;
    Tiling tiling_;
    GridSize samples_;
    uint32_t level_;
    std::vector<SourceFile> files_;
};

}  // namespace

ComputedDataset::ComputedDataset(const HeightFunction& heights, GridSize size, double spacing,
                                 const PhotoFunction& photo, uint32_t photoLevel) {
    build(FunctionHeights(heights, size, spacing), [&](const Tiling& tiling, const HeightGridInfo& info) {
        return std::make_unique<FunctionPhoto>(photo, tiling, info.size, photoLevel);
    });
}

ComputedDataset::ComputedDataset(const HeightFunction& heights, GridSize size, double spacing,
                                 std::optional<double> quantum) {
    build(FunctionHeights(heights, size, spacing), nullptr, quantum);
}

ComputedDataset::ComputedDataset(int64_t size, double spacing, uint64_t seed) {
    build(*makeSyntheticHeights({.size = size, .spacing = spacing, .seed = seed}));
}

void ComputedDataset::build(const HeightSource& heights, const OpenPhoto& openPhoto, std::optional<double> quantum) {
    static std::atomic<int> counter = 0;
    parent_ = std::filesystem::path(testing::TempDir()) /
              ("terray_e2e_" + std::to_string(getpid()) + "_" + std::to_string(counter++));
    std::filesystem::create_directories(parent_);
    directory_ = parent_ / "dataset";
    BuildRequest request;
    request.out = directory_;
    request.jobs = 2;
    request.quantum = quantum;
    (void)buildDataset(heights, openPhoto, request);
    source_ = openLocalDataset(directory_);
}

ComputedDataset::~ComputedDataset() {
    source_.reset();
    std::error_code ignored;
    std::filesystem::remove_all(parent_, ignored);
}

EngineOptions inspectedOptions(Surface surface) {
    EngineOptions options;
    options.render.surface = surface;
    options.features.signalSky = true;
    options.features.statistics = true;
    options.features.normals = true;
    return options;
}

Camera cameraAt(glm::dvec3 position, double headingDegrees, double pitchDegrees, double fovDegrees) {
    return {.position = position,
            .heading = radiansFromDegrees(headingDegrees),
            .pitch = radiansFromDegrees(pitchDegrees),
            .verticalFov = radiansFromDegrees(fovDegrees)};
}

ColourDifference colourDifference(const Grid<Rgba>& a, const Grid<Rgba>& b) {
    TERRAY_CHECK(a.size() == b.size());
    ColourDifference difference;
    for (size_t n = 0; n < a.cells().size(); ++n) {
        int most = 0;
        for (size_t channel = 0; channel < 3; ++channel)
            most = std::max(most, std::abs(int{a.cells()[n][channel]} - int{b.cells()[n][channel]}));
        difference.byOneStep += most == 1;
        difference.byMore += most > 1;
    }
    return difference;
}

void expectSameColours(const FrameTargets& one, const FrameTargets& other) {
    const Grid<Rgba> colours = one.readSrgb();
    const ColourDifference difference = colourDifference(colours, other.readSrgb());
    EXPECT_EQ(difference.byMore, 0);
    EXPECT_LE(difference.byOneStep, colours.size().count() / 1000);
}

int64_t raysOutOfSteps(const FrameTargets& targets) {
    int64_t count = 0;
    const Grid<uint32_t> steps = targets.readSteps();
    for (const uint32_t ofPixel : steps.cells()) count += (ofPixel & kOutOfStepsBit) != 0 ? 1 : 0;
    return count;
}

}  // namespace terray
