#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <thread>

#include <glm/geometric.hpp>

#include "client/bench/measured_frame.h"
#include "client/bench/stability.h"
#include "client/engine/program.h"
#include "client/render/frame_targets.h"
#include "common/parallel.h"
#include "common/reference/dataset_heights.h"
#include "common/reference/pixel_pattern.h"

namespace terray {
namespace {

/// Pixels of a picture that are looked at: all of small ones, a pattern of large ones.
constexpr size_t kMostPixels = 4096;

constexpr std::array kCasters{StabilityCaster::gpuRaster, StabilityCaster::gpuCompute, StabilityCaster::cpuFloat,
                              StabilityCaster::cpuDouble};

bool canCast(StabilityCaster caster, const MethodOptions& method) {
    if (caster == StabilityCaster::gpuRaster) return true;
    if (caster == StabilityCaster::gpuCompute) return !entryOf(method.method).geometry;
    return method.method == Method::pyramid;
}

EngineOptions optionsOf(Launch launch, bool columns, const MethodOptions& method) {
    EngineOptions options = finestOf({}, 1e-6);
    options.render.surface = columns ? Surface::columns : Surface::bilinear;
    options.render.method = method;
    options.render.launch = launch;
    options.features.statistics = true;
    options.selection.useImagery = false;
    options.earth.shape = EarthShape::flat;  // views say it themselves
    return options;
}

/// Where the rays of some pixels end, and after how many steps.
struct CastPixels {
    std::vector<DrawnPixel> drawn;
    std::vector<uint32_t> steps;
};

/// All casters over views of one ground.
class Casting {
  public:
    Casting(const FormulaDataset& ground, const ShaderLibrary& shaders, bool columns, const MethodOptions& method)
        : ground_(ground), shaders_(shaders), columns_(columns), method_(method), march_(ground) {}

    /// On the CPU the nodes of the last view that gpuRaster cast.
    CastPixels cast(StabilityCaster caster, const View& view, std::span<const glm::ivec2> pixels) {
        throwIfInterrupted();
        CastPixels result{.steps = std::vector<uint32_t>(pixels.size())};
        if (caster == StabilityCaster::cpuFloat || caster == StabilityCaster::cpuDouble) {
            const Precision precision = caster == StabilityCaster::cpuFloat ? Precision::single : Precision::full;
            const Surface surface = columns_ ? Surface::columns : Surface::bilinear;
            result.drawn = march_.draw(nodes(), view, surface, precision, pixels, result.steps);
            return result;
        }
        const bool compute = caster == StabilityCaster::gpuCompute;
        Engine& engine = engineFor(compute ? compute_ : raster_, compute ? Launch::compute : Launch::raster, view);
        requireAllTiles(engine.drawView(view, true), "the stability suite was broken off");
        result.drawn = drawnPixels(engine, pixels);
        const Grid<uint32_t> steps = engine.targets().readSteps();
        for (size_t n = 0; n < pixels.size(); ++n) result.steps[n] = steps.at(pixels[n].x, pixels[n].y);
        return result;
    }
    /// Of the last view that gpuRaster cast; every caster's are the same.
    [[nodiscard]] const std::vector<DrawNode>& nodes() const { return raster_->nodes(); }

  private:
    Engine& engineFor(std::unique_ptr<Engine>& engine, Launch launch, const View& view) {
        const bool fits =
            engine && engine->targets().width() == view.width && engine->targets().height() == view.height;
        if (!fits) {
            engine.reset();
            engine = std::make_unique<Engine>(ground_, shaders_, optionsOf(launch, columns_, method_), view.width,
                                              view.height);
        }
        return *engine;
    }

    const FormulaDataset& ground_;
    const ShaderLibrary& shaders_;
    bool columns_;
    MethodOptions method_;
    ShaderMarch march_;
    std::unique_ptr<Engine> raster_;
    std::unique_ptr<Engine> compute_;
};

/// Metres from a drawn point to the true surface: straight up or down, or along the ray, the shorter way.
double metresOff(const GroundCaster& truth, const View& view, const glm::dvec3& direction, const DrawnPixel& drawn,
                 const PixelError& error) {
    const double along = error.depthMetres * glm::length(direction);
    const std::optional<double> height = truth.heightAt(drawn.place.x, drawn.place.y);
    return height ? std::min(along, std::abs(drawn.place.z - *height) * view.exaggeration) : along;
}

BoundTerms termsOf(const FormulaDataset& ground, const StabilityScene& scene, const View& view,
                   std::span<const DrawNode> nodes, const StabilityRow& row) {
    const DatasetMetadata& metadata = ground.metadata();
    uint32_t coarsest = metadata.tiling.finestLevel;
    for (const DrawNode& node : nodes) coarsest = std::min(coarsest, node.heightTile.level);
    const GroundRect bounds = metadata.groundBounds();
    return {
        .precision = row.caster == StabilityCaster::cpuDouble ? Precision::full : Precision::single,
        .columns = row.columns,
        .tileSide = metadata.tiling.tileSide(coarsest),
        .spacing = metadata.tiling.finestSpacing,
        .codeStep = HeightEncoding::covering(metadata.minHeight, metadata.maxHeight, metadata.quantum).metresPerCode(),
        .quantum = metadata.quantum,
        .coordinates =
            std::max({std::abs(bounds.west), std::abs(bounds.east), std::abs(bounds.south), std::abs(bounds.north),
                      std::abs(view.eye.x), std::abs(view.eye.y), std::abs(view.eye.z)}),
        .relief = scene.relief};
}

/// Below all that is drawn, roundings included.
double lowestOf(std::span<const DrawNode> nodes, const View& view, double floor, double codeStep) {
    double lowest = floor;
    for (const DrawNode& node : nodes) lowest = std::min(lowest, node.minHeight);
    return lowest - 2 * codeStep - 1e-5 * std::abs(view.eye.z / view.exaggeration - lowest);
}

/// A ray's verdict, and how far it is from the truth.
struct Judged {
    RayVerdict verdict = RayVerdict::right;
    double metres = 0;
    double pixels = 0;
};

void add(const Judged& judged, uint32_t steps, double spacing, StabilityRow& row) {
    ++row.rays;
    row.wrong += judged.verdict != RayVerdict::right ? 1 : 0;
    row.notANumber += judged.verdict == RayVerdict::notANumber ? 1 : 0;
    row.seeThrough += judged.verdict == RayVerdict::seeThrough ? 1 : 0;
    row.coversSky += judged.verdict == RayVerdict::coversSky ? 1 : 0;
    row.misplaced += judged.verdict == RayVerdict::misplaced ? 1 : 0;
    row.worstTexels = std::max(row.worstTexels, judged.metres / spacing);
    row.worstPixels = std::max(row.worstPixels, judged.pixels);
    row.outOfSteps += (steps & kOutOfStepsBit) != 0 ? 1 : 0;
    row.worstSteps = std::max(row.worstSteps, steps & kStepCountMask);
}

/// Adds what one picture came to, on all cores.
void judge(const GroundCaster& truth, const View& view, const StabilityBound& bound, double lowest,
           std::span<const glm::ivec2> pixels, const CastPixels& cast, StabilityRow& row) {
    constexpr size_t kAtATime = 64;
    std::vector<Judged> judged(pixels.size());
    const std::atomic<bool> never = false;
    const auto cores = static_cast<int>(std::max(std::thread::hardware_concurrency(), 1U));
    forEachParallel((pixels.size() + kAtATime - 1) / kAtATime, cores, never, [&](int, size_t part) {
        for (size_t n = part * kAtATime; n < std::min((part + 1) * kAtATime, pixels.size()); ++n) {
            judged[n].verdict = judgeRay(truth, view, pixels[n], cast.drawn[n], bound, lowest);
            const PixelError error = pixelError(truth, view, pixels[n], cast.drawn[n]);
            if (error.kind != PixelError::Kind::ground) continue;
            const glm::dvec3 direction = view.direction(pixels[n].x + 0.5, pixels[n].y + 0.5);
            judged[n].metres = metresOff(truth, view, direction, cast.drawn[n], error);
            judged[n].pixels = error.pixels;
        }
    });
    for (size_t n = 0; n < pixels.size(); ++n) add(judged[n], cast.steps[n], truth.spacing(), row);
}

/// Pixels of a mirrored picture that are not those of the other one mirrored, in their order.
uint64_t countUnmirrored(const CastPixels& picture, const CastPixels& mirrored) {
    uint64_t count = 0;
    for (size_t n = 0; n < picture.drawn.size(); ++n) {
        const DrawnPixel& a = picture.drawn[n];
        const DrawnPixel& b = mirrored.drawn[n];
        count += a.ground != b.ground || std::memcmp(&a.depth, &b.depth, sizeof(a.depth)) != 0 ||
                         picture.steps[n] != mirrored.steps[n]
                     ? 1
                     : 0;
    }
    return count;
}

/// The pixels that a mirrored picture has in place of these.
std::vector<glm::ivec2> opposite(std::vector<glm::ivec2> pixels, int width) {
    for (glm::ivec2& pixel : pixels) pixel.x = width - 1 - pixel.x;
    return pixels;
}

/// A row for each caster of a surface.
std::vector<StabilityRow> runSurface(const StabilityScene& scene, const GroundCaster& truth,
                                     const ShaderLibrary& shaders, std::vector<StabilityRow> rows,
                                     const MethodOptions& method) {
    const bool columns = rows.front().columns;
    Casting casting(*scene.ground, shaders, columns, method);
    std::unique_ptr<Casting> mirrored;
    if (scene.mirroredGround) mirrored = std::make_unique<Casting>(*scene.mirroredGround, shaders, columns, method);
    for (size_t n = 0; n < scene.views.size(); ++n) {
        const View& view = scene.views[n];
        const std::vector<glm::ivec2> pixels = pixelPattern(view.width, view.height, kMostPixels);
        for (StabilityRow& row : rows) {
            const CastPixels cast = casting.cast(row.caster, view, pixels);
            const BoundTerms terms = termsOf(*scene.ground, scene, view, casting.nodes(), row);
            const double lowest = lowestOf(casting.nodes(), view, truth.floor(), terms.codeStep);
            judge(truth, view, stabilityBound(view, terms), lowest, pixels, cast, row);
            if (!mirrored) continue;
            const CastPixels inMirror =
                mirrored->cast(row.caster, scene.mirroredViews[n], opposite(pixels, view.width));
            const uint64_t unmirrored = countUnmirrored(cast, inMirror);
            row.unmirrored += unmirrored;
            row.wrong += unmirrored;
        }
    }
    return rows;
}

}  // namespace

const char* name(StabilityCaster caster) {
    constexpr std::array<const char*, 4> kNames{"GPU raster", "GPU compute", "CPU float", "CPU double"};
    return kNames[static_cast<size_t>(caster)];
}

std::vector<StabilityRow> runStabilityCase(const StabilityCase& of, const ShaderLibrary& shaders,
                                           const MethodOptions& method) {
    const StabilityScene scene = of.scene();
    const FormulaDataset& ground = *scene.ground;
    const DatasetHeights heights(ground.metadata(),
                                 [&](const TileId& id) { return ground.read(TileLayer::heights, id); });
    const GroundCaster truth(heights, ground.metadata().tiling, floorBelow(ground.metadata()));
    std::vector<StabilityRow> all;
    for (const bool columns : {false, true}) {
        std::vector<StabilityRow> rows;
        for (const StabilityCaster caster : kCasters)
            if (canCast(caster, method)) rows.push_back({.name = of.name, .caster = caster, .columns = columns});
        rows = runSurface(scene, truth, shaders, std::move(rows), method);
        all.insert(all.end(), rows.begin(), rows.end());
    }
    return all;
}

}  // namespace terray
