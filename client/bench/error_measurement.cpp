#include "client/bench/error_measurement.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "client/engine/program.h"
#include "common/error.h"
#include "common/percentile.h"
#include "common/reference/pixel_pattern.h"
#include "common/srgb.h"

namespace terray {
namespace {

/// Just below the lowest ground, so that rays along it do not end by rounding.
double floorOf(const DatasetMetadata& metadata) {
    constexpr double kShareOfRange = 1e-3;
    return metadata.minHeight - std::max(kShareOfRange * (metadata.maxHeight - metadata.minHeight), metadata.quantum);
}

FrameReport draw(Engine& engine, const Camera& camera) {
    throwIfInterrupted();
    FrameReport report = engine.drawFrame(camera, true);
    if (!report.failures.empty())
        throw Error(ExitCode::dataset, "the measurement was broken off: " + report.failures.front() +
                                           " (terray-preprocess verify lists all damaged tiles)");
    return report;
}

std::vector<DrawnPixel> drawnPixels(const Engine& engine, std::span<const glm::ivec2> pixels) {
    const Grid<uint32_t> nodes = engine.targets().readNodes();
    const Grid<glm::vec4> hits = engine.targets().readHits();
    std::vector<DrawnPixel> drawn(pixels.size());
    for (size_t n = 0; n < pixels.size(); ++n) {
        const uint32_t node = nodes.at(pixels[n].x, pixels[n].y);
        if (node == 0) continue;
        const glm::vec4 hit = hits.at(pixels[n].x, pixels[n].y);
        drawn[n] = {.ground = true, .depth = hit.w, .place = engine.worldFromHit(engine.nodes()[node - 1], hit)};
    }
    return drawn;
}

/// FLIP and PSNR of all frames.
class PictureTotals {
  public:
    void add(GridView<const Rgba> reference, GridView<const Rgba> test) {
        const Grid<float> flip = flipOf(reference, test);
        flips_.push_back(static_cast<float>(spreadOf(flip.cells()).mean));
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
      truth_(heights_, source.metadata().tiling, floorOf(source.metadata())) {}

Camera ErrorMeasurement::cameraOf(int frame) const {
    if (protocol_.frames == 1) return flight_.at(0);
    return flight_.at(flight_.seconds() * frame / (protocol_.frames - 1));
}

void ErrorMeasurement::drawReferences(const EngineOptions& base) {
    EngineOptions finest = base;
    finest.selection.tolerance = Pixels(0.25);
    finest.selection.imageryTolerance = Pixels(1);
    finest.render.surface = Surface::bilinear;
    finest.render.method = Method::pyramid;
    finest.render.anisotropy = 16;
    const int times = protocol_.supersampling;
    Engine engine(source_, shaders_, finest, protocol_.width * times, protocol_.height * times);
    references_.clear();
    for (int frame = 0; frame < protocol_.frames; ++frame) {
        draw(engine, cameraOf(frame));
        references_.push_back(averaged(engine.targets().readSrgb().view(), times));
    }
}

ErrorResult ErrorMeasurement::measure(const ErrorSetting& setting, const TakeErrors& take) {
    ErrorResult result{.curve = setting.curve, .name = setting.name};
    Engine engine(source_, shaders_, setting.options, protocol_.width, protocol_.height);
    time(engine, result);

    const bool all = protocol_.pixels == 0;
    const size_t count = all ? SIZE_MAX : static_cast<size_t>(protocol_.pixels);
    const std::vector<glm::ivec2> pixels = pixelPattern(protocol_.width, protocol_.height, count);
    ErrorTotals totals;
    PictureTotals pictures;
    for (int frame = 0; frame < protocol_.frames; ++frame) {
        const FrameReport report = draw(engine, cameraOf(frame));
        result.nodes += report.nodes;
        result.lacking += report.wanted;
        result.gpuBytes = report.gpuTiles.heights + report.gpuTiles.maxima + report.gpuTiles.imagery;
        const auto errors = pixelErrors(truth_, engine.view(), pixels, drawnPixels(engine, pixels));
        totals.add(errors);
        if (take) take(setting.name, frame, errors);
        pictures.add(references_[static_cast<size_t>(frame)].view(), engine.targets().readSrgb().view());
    }
    result.pixels = totals.pixels;
    result.seeThrough = totals.seeThrough;
    result.coversSky = totals.coversSky;
    result.errorPixels = spreadOf(totals.errorPixels);
    result.depthMetres = spreadOf(totals.depthMetres);
    result.depthRelative = spreadOf(totals.depthRelative);
    pictures.tell(result);
    return result;
}

/// The first round loads tiles and compiles programs, and is not counted.
void ErrorMeasurement::time(Engine& engine, ErrorResult& result) const {
    for (int round = 0; round <= protocol_.repeats; ++round) {
        std::vector<double> frames;
        for (int frame = 0; frame < protocol_.frames; ++frame) frames.push_back(draw(engine, cameraOf(frame)).frameMs);
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
