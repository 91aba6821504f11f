#include "client/bench/measured_frame.h"

#include <algorithm>

#include "client/engine/program.h"
#include "common/error.h"

namespace terray {

FrameReport drawWhole(Engine& engine, const Camera& camera) {
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

double floorBelow(const DatasetMetadata& metadata) {
    constexpr double kShareOfRange = 1e-3;
    return metadata.minHeight - std::max(kShareOfRange * (metadata.maxHeight - metadata.minHeight), metadata.quantum);
}

double meanFlip(GridView<const Rgba> reference, GridView<const Rgba> test) {
    const Grid<float> flip = flipOf(reference, test);
    return spreadOf(flip.cells()).mean;
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
