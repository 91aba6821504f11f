#include "tests/e2e/scene.h"

#include <atomic>

#include <gtest/gtest.h>
#include <unistd.h>

#include "preprocess/dataset_builder.h"
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

}  // namespace

ComputedDataset::ComputedDataset(const HeightFunction& heights, GridSize size, double spacing) {
    build(FunctionHeights(heights, size, spacing));
}

ComputedDataset::ComputedDataset(int64_t size, double spacing, uint64_t seed) {
    build(*makeSyntheticHeights({.size = size, .spacing = spacing, .seed = seed}));
}

void ComputedDataset::build(const HeightSource& heights) {
    static std::atomic<int> counter = 0;
    parent_ = std::filesystem::path(testing::TempDir()) /
              ("terray_e2e_" + std::to_string(getpid()) + "_" + std::to_string(counter++));
    std::filesystem::create_directories(parent_);
    directory_ = parent_ / "dataset";
    BuildRequest request;
    request.out = directory_;
    request.jobs = 2;
    (void)buildDataset(heights, nullptr, request);
    source_ = openLocalDataset(directory_);
}

ComputedDataset::~ComputedDataset() {
    source_.reset();
    std::error_code ignored;
    std::filesystem::remove_all(parent_, ignored);
}

EngineOptions inspectedOptions() {
    EngineOptions options;
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

int64_t raysOutOfSteps(const FrameTargets& targets) {
    int64_t count = 0;
    const Grid<uint32_t> steps = targets.readSteps();
    for (const uint32_t ofPixel : steps.cells()) count += ofPixel >> 31;
    return count;
}

}  // namespace terray
