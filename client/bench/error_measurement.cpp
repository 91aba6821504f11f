#include "client/bench/error_measurement.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "client/bench/measured_frame.h"
#include "client/bench/requantised_source.h"
#include "common/percentile.h"
#include "common/reference/pixel_pattern.h"
#include "common/srgb.h"

namespace terray {
namespace {

/// FLIP and PSNR of all frames.
class PictureTotals {
  public:
    void add(GridView<const Rgba> reference, GridView<const Rgba> test) {
        flips_.push_back(static_cast<float>(meanFlip(reference, test)));
        if (const auto ratio = psnr(reference, test)) ratios_.push_back(*ratio);
    }
    void tell(ErrorResult& result) const {
        result.flip = spreadOf(flips_);
        if (ratios_.empty()) return;
        result.psnr = std::accumulate(ratios_.begin(), ratios_.end(), 0.0) / static_cast<double>(ratios_.size());
    }

  private:
    std::vector<float> flips_;
    std::vector<double> ratios_;
};

}  // namespace

ErrorMeasurement::ErrorMeasurement(const TileSource& source, const ShaderLibrary& shaders, const Flight& flight,
                                   const ErrorProtocol& protocol)
    : source_(source),
      shaders_(shaders),
      flight_(flight),
      protocol_(protocol),
      heights_(source.metadata(), [&source](const TileId& id) { return source.read(TileLayer::heights, id); }),
      truth_(heights_, source.metadata().tiling, floorBelow(source.metadata())) {}

double ErrorMeasurement::secondsOf(int frame) const {
    return protocol_.frames == 1 ? 0 : flight_.seconds() * frame / (protocol_.frames - 1);
}

Camera ErrorMeasurement::cameraOf(int frame) const {
    return flight_.at(secondsOf(frame));
}

Camera ErrorMeasurement::cameraBeside(int frame) const {
    const double step = 1 / protocol_.framesPerSecond;
    const double seconds = secondsOf(frame);
    return flight_.at(seconds + step <= flight_.seconds() ? seconds + step : seconds - step);
}

void ErrorMeasurement::drawReferences(const EngineOptions& base) {
    const int times = protocol_.supersampling;
    references_.clear();
    {
        Engine engine(source_, shaders_, finestOf(base, 0.25), protocol_.width * times, protocol_.height * times);
        for (int frame = 0; frame < protocol_.frames; ++frame) {
            drawWhole(engine, cameraOf(frame));
            references_.push_back(averaged(engine.targets().readSrgb().view(), times));
        }
    }
    finestChanges_.clear();
    Engine engine(source_, shaders_, finestOf(base, 0.25), protocol_.width, protocol_.height);
    for (int frame = 0; frame < protocol_.frames; ++frame) {
        drawWhole(engine, cameraOf(frame));
        const Grid<Rgba> picture = engine.targets().readSrgb();
        drawWhole(engine, cameraBeside(frame));
        finestChanges_.push_back(meanFlip(picture.view(), engine.targets().readSrgb().view()));
    }
}

ErrorResult ErrorMeasurement::measure(const ErrorSetting& setting, const TakeErrors& take) {
    ErrorResult result{.curve = setting.curve, .name = setting.name};
    std::optional<RequantisedSource> coarser;
    if (setting.quantum > 0) coarser.emplace(source_, setting.quantum);
    const TileSource& source = coarser ? *coarser : source_;
    EngineOptions measured = setting.options;
    measured.measurePreparation = true;  // of tiles that the untimed round loads
    Engine engine(source, shaders_, measured, protocol_.width, protocol_.height);
    time(engine, result);

    const bool all = protocol_.pixels == 0;
    const size_t count = all ? SIZE_MAX : static_cast<size_t>(protocol_.pixels);
    const std::vector<glm::ivec2> pixels = pixelPattern(protocol_.width, protocol_.height, count);
    ErrorTotals totals;
    PictureTotals pictures;
    std::vector<float> popping;
    for (int frame = 0; frame < protocol_.frames; ++frame) {
        const FrameReport report = drawWhole(engine, cameraOf(frame));
        result.nodes += report.nodes;
        result.lacking += report.wanted;
        result.gpuBytes =
            report.gpuTiles.heights + report.gpuTiles.maxima + report.gpuTiles.imagery + report.gpuTiles.method;
        result.methodBytes = report.gpuTiles.method;
        const auto errors = pixelErrors(truth_, engine.view(), pixels, drawnPixels(engine, pixels));
        totals.add(errors);
        if (take) take(setting.name, frame, errors);
        const Grid<Rgba> picture = engine.targets().readSrgb();
        pictures.add(references_[static_cast<size_t>(frame)].view(), picture.view());
        drawWhole(engine, cameraBeside(frame));
        const double change = meanFlip(picture.view(), engine.targets().readSrgb().view());
        popping.push_back(static_cast<float>(change - finestChanges_[static_cast<size_t>(frame)]));
    }
    const Preparation& preparation = engine.tiles().preparation();
    result.pyramidMs = preparation.pyramidMs / static_cast<double>(preparation.tiles);
    result.prepareMs = preparation.methodMs / static_cast<double>(preparation.tiles);
    result.pixels = totals.pixels;
    result.seeThrough = totals.seeThrough;
    result.coversSky = totals.coversSky;
    result.errorPixels = spreadOf(totals.errorPixels);
    result.depthMetres = spreadOf(totals.depthMetres);
    result.depthRelative = spreadOf(totals.depthRelative);
    pictures.tell(result);
    result.popping = spreadOf(popping);
    return result;
}

/// The first round loads tiles and compiles programs, and is not counted.
void ErrorMeasurement::time(Engine& engine, ErrorResult& result) const {
    for (int round = 0; round <= protocol_.repeats; ++round) {
        std::vector<double> frames;
        for (int frame = 0; frame < protocol_.frames; ++frame)
            frames.push_back(drawWhole(engine, cameraOf(frame)).frameMs);
        std::sort(frames.begin(), frames.end());
        if (round > 0) result.frameMs.push_back(percentile<double>(frames, 50));
    }
    std::sort(result.frameMs.begin(), result.frameMs.end());
}

Grid<Rgba> averaged(GridView<const Rgba> picture, int supersampling) {
    Grid<Rgba> result({picture.width() / supersampling, picture.height() / supersampling}, {0, 0, 0, 255});
    const auto samples = static_cast<float>(supersampling * supersampling);
    for (int64_t y = 0; y < result.height(); ++y)
        for (int64_t x = 0; x < result.width(); ++x)
            for (size_t channel = 0; channel < 3; ++channel) {
                float light = 0;
                for (int dy = 0; dy < supersampling; ++dy)
                    for (int dx = 0; dx < supersampling; ++dx)
                        light += linearFromSrgb(picture.at(x * supersampling + dx, y * supersampling + dy)[channel]);
                result.at(x, y)[channel] = srgbFromLinear(light / samples);
            }
    return result;
}

}  // namespace terray
