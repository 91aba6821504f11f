#include "client/bench/measured_frame.h"

#include <algorithm>
#include <numeric>

#include "client/engine/program.h"
#include "common/srgb.h"

namespace terray {

size_t ErrorProtocol::pixelsLookedAt() const {
    return pixels == 0 ? SIZE_MAX : static_cast<size_t>(pixels);
}

double secondsOf(const Flight& flight, const ErrorProtocol& protocol, int frame) {
    return protocol.frames == 1 ? 0 : flight.seconds() * frame / (protocol.frames - 1);
}

Camera cameraOf(const Flight& flight, const ErrorProtocol& protocol, int frame) {
    return flight.at(secondsOf(flight, protocol, frame));
}

FrameReport drawWhole(Engine& engine, const Camera& camera) {
    throwIfInterrupted();
    FrameReport report = engine.drawFrame(camera, true);
    requireAllTiles(report, "the measurement was broken off");
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

double floorBelow(const DatasetMetadata& metadata) {
    constexpr double kShareOfRange = 1e-3;
    return metadata.minHeight - std::max(kShareOfRange * (metadata.maxHeight - metadata.minHeight), metadata.quantum);
}

double meanFlip(GridView<const Rgba> reference, GridView<const Rgba> test) {
    const Grid<float> flip = flipOf(reference, test);
    return spreadOf(flip.cells()).mean;
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

void PictureTotals::add(GridView<const Rgba> reference, GridView<const Rgba> test) {
    flips_.push_back(static_cast<float>(meanFlip(reference, test)));
    if (const auto ratio = terray::psnr(reference, test)) ratios_.push_back(*ratio);
}

std::optional<double> PictureTotals::psnr() const {
    if (ratios_.empty()) return std::nullopt;
    return std::accumulate(ratios_.begin(), ratios_.end(), 0.0) / static_cast<double>(ratios_.size());
}

EngineOptions finestOf(const EngineOptions& base, double tolerance) {
    EngineOptions finest = base;
    finest.selection.tolerance = Pixels(tolerance);
    finest.selection.imageryTolerance = Pixels(1);
    finest.render.surface = Surface::bilinear;
    finest.render.method = {};
    finest.render.anisotropy = 16;
    return finest;
}

}  // namespace terray
