#include "client/bench/error_split.h"

#include <array>
#include <chrono>
#include <cmath>
#include <limits>

#include "client/bench/photo_compression.h"
#include "client/bench/shader_march.h"
#include "common/error.h"
#include "common/reference/pixel_pattern.h"

namespace terray {
namespace {

DatasetHeights heightsOf(const TileSource& source, Rounding rounding) {
    return {source.metadata(), [&source](const TileId& id) { return source.read(TileLayer::heights, id); }, rounding};
}

/// What a picture of the truth of other heights shows.
std::vector<DrawnPixel> castPixels(const GroundCaster& caster, const View& view, std::span<const glm::ivec2> pixels) {
    std::vector<DrawnPixel> drawn(pixels.size());
    for (size_t n = 0; n < pixels.size(); ++n) {
        const glm::dvec3 direction = view.direction(pixels[n].x + 0.5, pixels[n].y + 0.5);
        const std::optional<double> depth = caster.meet(view, direction);
        if (!depth) continue;
        drawn[n] = {.ground = true, .depth = *depth, .place = view.at(direction, *depth)};
        drawn[n].place.z /= view.exaggeration;
    }
    return drawn;
}

CauseResult groundResult(const std::string& cause, const ErrorTotals& totals) {
    return {.cause = cause, .ground = groundErrorOf(totals)};
}

/// A frame of a flight at full speed, as it was seen.
struct SeenFrame {
    Camera camera;
    View view;
    std::vector<DrawnPixel> pixels;
    Grid<Rgba> picture;
};

/// Samples by their size on the picture, in pixels.
struct SampleClass {
    const char* name;
    double below;
};
constexpr std::array<SampleClass, 5> kSampleClasses{{{"samples below 1/2 px", 0.5},
                                                     {"samples of 1/2 to 1 px", 1},
                                                     {"samples of 1 to 2 px", 2},
                                                     {"samples of 2 to 4 px", 4},
                                                     {"samples above 4 px", std::numeric_limits<double>::infinity()}}};

/// Which class each pixel of the last frame belongs to; sky: none, kSampleClasses.size().
Grid<size_t> classesOf(const Engine& engine, const Tiling& tiling) {
    const Grid<uint32_t> nodes = engine.targets().readNodes();
    const Grid<glm::vec4> hits = engine.targets().readHits();
    Grid<size_t> classes(nodes.size(), kSampleClasses.size());
    for (int64_t y = 0; y < nodes.height(); ++y)
        for (int64_t x = 0; x < nodes.width(); ++x) {
            if (nodes.at(x, y) == 0) continue;
            const uint32_t level = engine.nodes()[nodes.at(x, y) - 1].heightTile.level;
            const double pixels = tiling.spacing(level) * engine.view().focalPixels() / hits.at(x, y).w;
            size_t& of = classes.at(x, y);
            of = 0;
            while (pixels >= kSampleClasses[of].below) ++of;
        }
    return classes;
}

/// Columns against bilinear patches of the same nodes, for one class of samples.
struct SurfaceTotals {
    ErrorTotals columns;
    ErrorTotals bilinear;
    double flip = 0;
    uint64_t flipPixels = 0;
};

}  // namespace

GroundError groundErrorOf(const ErrorTotals& totals) {
    return {.pixels = totals.pixels,
            .seeThrough = totals.seeThrough,
            .coversSky = totals.coversSky,
            .errorPixels = spreadOf(totals.errorPixels),
            .depthMetres = spreadOf(totals.depthMetres)};
}

ErrorSplit::ErrorSplit(const TileSource& source, const ShaderLibrary& shaders, const Flight& flight,
                       const ErrorProtocol& protocol, const EngineOptions& base)
    : source_(source),
      shaders_(shaders),
      flight_(flight),
      protocol_(protocol),
      base_(base),
      pixels_(pixelPattern(protocol.width, protocol.height, protocol.pixelsLookedAt())),
      heights_(heightsOf(source, Rounding::asStored)),
      truth_(heights_, source.metadata().tiling, floorBelow(source.metadata())) {}

std::vector<CauseResult> ErrorSplit::measure() {
    std::vector<CauseResult> results;
    const Pictures best = supersampled(finest());
    results.push_back(against(best, "all together", base_));
    std::vector<CauseResult> arithmetic;
    drawFinest(arithmetic);

    EngineOptions options = finest();
    options.selection.tolerance = base_.selection.tolerance;
    results.push_back(against(finestPictures_, "level of detail", options));
    options = finest();
    options.render.surface = base_.render.surface;
    results.push_back(against(finestPictures_, "surface", options));
    if (base_.render.method != MethodOptions()) {
        options = finest();
        options.render.method = base_.render.method;
        results.push_back(against(finestPictures_, "method", options));
    }
    results.insert(results.end(), arithmetic.begin(), arithmetic.end());
    stream(results);

    const bool photo = base_.selection.useImagery && source_.metadata().imageryLevel.has_value();
    if (photo) {
        options = finest();
        options.render.anisotropy = base_.render.anisotropy;
        options.selection.imageryTolerance = base_.selection.imageryTolerance;
        results.push_back(against(best, "photo filter and edges", options));
        results.back().ground.reset();
    }
    options = finest();
    options.selection.useImagery = false;
    results.push_back(against(supersampled(options), "edges: one ray a pixel", options));
    results.back().ground.reset();
    if (const auto compression = photo ? measurePhotoCompression(source_) : std::nullopt)
        results.push_back({.cause = "photo compression", .flip = compression->flip, .psnr = compression->psnr});
    compareSurfaces(results);
    return results;
}

ErrorSplit::Pictures ErrorSplit::supersampled(const EngineOptions& options) const {
    const int times = protocol_.supersampling;
    Engine engine(source_, shaders_, options, protocol_.width * times, protocol_.height * times);
    Pictures pictures;
    for (int frame = 0; frame < protocol_.frames; ++frame) {
        drawWhole(engine, cameraOf(flight_, protocol_, frame));
        pictures.push_back(averaged(engine.targets().readSrgb().view(), times));
    }
    return pictures;
}

std::vector<PixelError> ErrorSplit::errorsOf(const View& view, std::span<const DrawnPixel> drawn) const {
    return pixelErrors(truth_, view, pixels_, drawn);
}

void ErrorSplit::drawFinest(std::vector<CauseResult>& results) {
    const DatasetHeights unrounded = heightsOf(source_, Rounding::undone);
    const GroundCaster before(unrounded, source_.metadata().tiling, truth_.floor());
    ShaderMarch march(source_);
    ErrorTotals steps, gpu, single, full;
    Engine engine(source_, shaders_, finest(), protocol_.width, protocol_.height);
    for (int frame = 0; frame < protocol_.frames; ++frame) {
        drawWhole(engine, cameraOf(flight_, protocol_, frame));
        const View& view = engine.view();
        finestPictures_.push_back(engine.targets().readSrgb());
        steps.add(errorsOf(view, castPixels(before, view, pixels_)));
        gpu.add(errorsOf(view, drawnPixels(engine, pixels_)));
        const auto marched = [&](Precision precision) {
            return errorsOf(view, march.draw(engine.nodes(), view, Surface::bilinear, precision, pixels_));
        };
        single.add(marched(Precision::single));
        full.add(marched(Precision::full));
    }
    results.push_back(groundResult("height steps", steps));
    results.push_back(groundResult("float, on the GPU", gpu));
    results.push_back(groundResult("float, on the CPU", single));
    results.push_back(groundResult("double, on the CPU", full));
}

CauseResult ErrorSplit::against(const Pictures& pictures, const std::string& cause,
                                const EngineOptions& options) const {
    Engine engine(source_, shaders_, options, protocol_.width, protocol_.height);
    ErrorTotals ground;
    PictureTotals seen;
    for (int frame = 0; frame < protocol_.frames; ++frame) {
        drawWhole(engine, cameraOf(flight_, protocol_, frame));
        ground.add(errorsOf(engine.view(), drawnPixels(engine, pixels_)));
        seen.add(pictures[static_cast<size_t>(frame)].view(), engine.targets().readSrgb().view());
    }
    return {.cause = cause, .ground = groundErrorOf(ground), .flip = seen.flip().mean, .psnr = seen.psnr()};
}

/// Flies by the wall clock without waiting for tiles, then draws what was seen once more with all of them.
void ErrorSplit::stream(std::vector<CauseResult>& results) const {
    std::vector<SeenFrame> frames;
    {
        Engine engine(source_, shaders_, base_, protocol_.width, protocol_.height);
        drawWhole(engine, flight_.at(0));
        const auto start = std::chrono::steady_clock::now();
        while (frames.size() < static_cast<size_t>(protocol_.frames)) {
            const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            const Camera camera = flight_.at(seconds);
            const FrameReport report = engine.drawFrame(camera, false);
            if (!report.failures.empty()) throw Error(ExitCode::dataset, report.failures.front());
            const double due = flight_.seconds() * static_cast<double>(frames.size() + 1) / protocol_.frames;
            if (seconds < due) continue;
            frames.push_back({camera, engine.view(), drawnPixels(engine, pixels_), engine.targets().readSrgb()});
        }
    }
    Engine engine(source_, shaders_, base_, protocol_.width, protocol_.height);
    ErrorTotals streamed, waited;
    PictureTotals seen;
    for (const SeenFrame& frame : frames) {
        drawWhole(engine, frame.camera);
        streamed.add(errorsOf(frame.view, frame.pixels));
        waited.add(errorsOf(engine.view(), drawnPixels(engine, pixels_)));
        seen.add(engine.targets().readSrgb().view(), frame.picture.view());
    }
    results.push_back(groundResult("streaming at full speed", streamed));
    results.back().flip = seen.flip().mean;
    results.back().psnr = seen.psnr();
    results.push_back(groundResult("the same, tiles waited for", waited));
}

void ErrorSplit::compareSurfaces(std::vector<CauseResult>& results) const {
    const Tiling& tiling = source_.metadata().tiling;
    std::array<SurfaceTotals, kSampleClasses.size()> totals;
    EngineOptions options = base_;
    options.render.method = {};
    options.render.surface = Surface::columns;
    Engine columns(source_, shaders_, options, protocol_.width, protocol_.height);
    options.render.surface = Surface::bilinear;
    Engine bilinear(source_, shaders_, options, protocol_.width, protocol_.height);
    for (int frame = 0; frame < protocol_.frames; ++frame) {
        const Camera camera = cameraOf(flight_, protocol_, frame);
        drawWhole(columns, camera);
        drawWhole(bilinear, camera);
        const Grid<size_t> classes = classesOf(bilinear, tiling);
        const auto add = [&](const Engine& engine, ErrorTotals SurfaceTotals::*of) {
            const std::vector<PixelError> errors = errorsOf(engine.view(), drawnPixels(engine, pixels_));
            for (size_t n = 0; n < errors.size(); ++n) {
                const size_t index = classes.at(pixels_[n].x, pixels_[n].y);
                if (index < totals.size()) (totals[index].*of).add({&errors[n], 1});
            }
        };
        add(columns, &SurfaceTotals::columns);
        add(bilinear, &SurfaceTotals::bilinear);
        const Grid<float> flip = flipOf(bilinear.targets().readSrgb().view(), columns.targets().readSrgb().view());
        for (int64_t y = 0; y < flip.height(); ++y)
            for (int64_t x = 0; x < flip.width(); ++x) {
                if (classes.at(x, y) >= totals.size()) continue;
                totals[classes.at(x, y)].flip += flip.at(x, y);
                ++totals[classes.at(x, y)].flipPixels;
            }
    }
    for (size_t n = 0; n < totals.size(); ++n) {
        if (totals[n].flipPixels == 0) continue;
        results.push_back(groundResult(std::string("columns, ") + kSampleClasses[n].name, totals[n].columns));
        results.back().flip = totals[n].flip / static_cast<double>(totals[n].flipPixels);
        results.push_back(groundResult(std::string("bilinear, ") + kSampleClasses[n].name, totals[n].bilinear));
    }
}

}  // namespace terray
