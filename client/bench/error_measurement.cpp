#include "client/bench/error_measurement.h"

#include <algorithm>

#include "client/bench/requantised_source.h"
#include "common/percentile.h"
#include "common/reference/pixel_pattern.h"

namespace terray {

ErrorMeasurement::ErrorMeasurement(const TileSource& source, const ShaderLibrary& shaders, const Flight& flight,
                                   const ErrorProtocol& protocol)
    : source_(source),
      shaders_(shaders),
      flight_(flight),
      protocol_(protocol),
      heights_(source.metadata(), [&source](const TileId& id) { return source.read(TileLayer::heights, id); }),
      truth_(heights_, source.metadata().tiling, floorBelow(source.metadata())) {}

Camera ErrorMeasurement::cameraBeside(int frame) const {
    const double step = 1 / protocol_.framesPerSecond;
    const double seconds = secondsOf(flight_, protocol_, frame);
    return flight_.at(seconds + step <= flight_.seconds() ? seconds + step : seconds - step);
}

void ErrorMeasurement::drawReferences(const EngineOptions& base) {
    const int times = protocol_.supersampling;
    references_.clear();
    {
        Engine engine(source_, shaders_, finestOf(base, 0.25), protocol_.width * times, protocol_.height * times);
        for (int frame = 0; frame < protocol_.frames; ++frame) {
            drawWhole(engine, cameraOf(flight_, protocol_, frame));
            references_.push_back(averaged(engine.targets().readSrgb().view(), times));
        }
    }
    finestChanges_.clear();
    Engine engine(source_, shaders_, finestOf(base, 0.25), protocol_.width, protocol_.height);
    for (int frame = 0; frame < protocol_.frames; ++frame) {
        drawWhole(engine, cameraOf(flight_, protocol_, frame));
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

    const std::vector<glm::ivec2> pixels = pixelPattern(protocol_.width, protocol_.height, protocol_.pixelsLookedAt());
    ErrorTotals totals;
    PictureTotals pictures;
    std::vector<float> popping;
    for (int frame = 0; frame < protocol_.frames; ++frame) {
        const FrameReport report = drawWhole(engine, cameraOf(flight_, protocol_, frame));
        result.nodes += report.nodes;
        result.lacking += report.wanted;
        result.gpuBytes =
            report.gpuTiles.heights + report.gpuTiles.maxima + report.gpuTiles.imagery + report.gpuTiles.method;
        result.pyramidBytes = report.gpuTiles.maxima;
        result.methodBytes = report.gpuTiles.method;
        result.bytesPerTriangle = report.bytesPerTriangle;
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
    result.flip = pictures.flip();
    result.psnr = pictures.psnr();
    result.popping = spreadOf(popping);
    return result;
}

/// The first round loads tiles and compiles programs, and is not counted.
void ErrorMeasurement::time(Engine& engine, ErrorResult& result) const {
    double triangles = 0, milliseconds = 0;
    for (int round = 0; round <= protocol_.repeats; ++round) {
        std::vector<double> frames;
        for (int frame = 0; frame < protocol_.frames; ++frame) {
            const FrameReport report = drawWhole(engine, cameraOf(flight_, protocol_, frame));
            frames.push_back(report.frameMs);
            if (round == 0) continue;
            triangles += static_cast<double>(report.triangles);
            milliseconds += report.frameMs;
        }
        std::sort(frames.begin(), frames.end());
        if (round > 0) result.frameMs.push_back(percentile<double>(frames, 50));
    }
    result.triangles = triangles / (protocol_.repeats * protocol_.frames);
    result.trianglesPerSecond = 1000 * triangles / milliseconds;
    std::sort(result.frameMs.begin(), result.frameMs.end());
}

}  // namespace terray
