#include "client/view/view.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>

#include <glm/common.hpp>

#include "client/engine/dataset_camera.h"
#include "client/engine/engine.h"
#include "client/engine/program.h"
#include "client/output/picture.h"
#include "client/render/gl_context.h"
#include "client/view/fly.h"
#include "client/view/picture_in_parts.h"
#include "client/view/snapshot.h"
#include "client/view/view_options.h"
#include "common/output_file.h"

namespace terray {
namespace {

enum class PictureKind { png, exr };

PictureKind kindOf(const std::filesystem::path& path) {
    const std::string extension = path.extension().string();
    if (extension == ".png") return PictureKind::png;
    if (extension == ".exr") return PictureKind::exr;
    throw Error(ExitCode::usage, "--out: found \"" + path.string() + "\", expected a name that ends in .png or .exr");
}

/// Fails before anything is drawn when the picture could not be written in the end.
void requireWritable(const std::filesystem::path& path, bool force) {
    if (std::filesystem::exists(path) && !force)
        throw Error(ExitCode::output, path.string() + " exists (give --force to replace it)");
    const OutputFile probe(path.string() + ".partial");  // removed again at once
}

EngineOptions engineOptions(const ViewOptions& options, PictureKind kind, const DatasetMetadata& metadata) {
    EngineOptions engine = options.engine.options(metadata.imageryLevel.has_value());
    // One picture is drawn sooner than a launch is calibrated.
    if (engine.render.launch == Launch::automatic) engine.render.launch = Launch::raster;
    if (kind == PictureKind::exr) {
        engine.features.statistics = engine.features.normals = true;
        engine.colour = ColourFormat::linearFloat;
    }
    return engine;
}

MeasuredPicture measure(const Engine& engine, const Camera& camera) {
    const FrameTargets& targets = engine.targets();
    const Grid<glm::vec4> hits = targets.readHits();
    const Grid<uint32_t> nodes = targets.readNodes();
    const Grid<uint32_t> steps = targets.readSteps();
    const GridSize size = hits.size();
    MeasuredPicture picture{.colour = targets.readLinear(),
                            .depthMetres = Grid<float>(size, std::numeric_limits<float>::infinity()),
                            .positionOrigin = glm::floor(camera.position),
                            .position = Grid<glm::vec3>(size, glm::vec3(0)),
                            .normal = targets.readNormals(),
                            .nodeLevel = Grid<uint32_t>(size),
                            .steps = Grid<uint32_t>(size),
                            .hit = Grid<uint32_t>(size)};
    for (size_t n = 0; n < hits.cells().size(); ++n) {
        picture.steps.cells()[n] = steps.cells()[n] & kStepCountMask;
        const uint32_t nodeNumber = nodes.cells()[n];
        if (nodeNumber == 0) continue;
        const DrawNode& node = engine.nodes().at(nodeNumber - 1);
        const glm::vec4& hit = hits.cells()[n];
        picture.hit.cells()[n] = 1;
        picture.depthMetres.cells()[n] = hit.w;
        picture.nodeLevel.cells()[n] = node.heightTile.level;
        picture.position.cells()[n] = glm::vec3(engine.worldFromHit(node, hit) - picture.positionOrigin);
    }
    return picture;
}

/// What was drawn: of parts the greatest numbers.
struct Drawn {
    FrameReport report;
    int parts = 1;
};

Drawn drawPng(Engine& engine, const Camera& camera, const ViewOptions& options) {
    PictureInParts picture(engine, camera, options.out,
                           {.size = {options.width, options.height}, .part = options.partSize()});
    while (!picture.finished()) {
        picture.drawNext();
        throwIfInterrupted();
    }
    return {picture.report(), picture.parts()};
}

Drawn drawExr(Engine& engine, const Camera& camera, const ViewOptions& options) {
    if (options.partSize())
        throw Error(ExitCode::usage, "--part-size: found an --out that ends in .exr, expected .png (EXR is one piece)");
    engine.resize(options.width, options.height);
    const FrameReport report = engine.drawFrame(camera, true);
    requireAllTiles(report, "no picture was written");
    throwIfInterrupted();
    writeExr(options.out, measure(engine, camera));
    return {report};
}

ExitCode drawHeadless(const ViewOptions& options) {
    if (options.out.empty()) throw Error(ExitCode::usage, "--headless needs --out FILE.png or FILE.exr");
    const std::filesystem::path out = options.out;
    const PictureKind kind = kindOf(out);

    const std::unique_ptr<TileSource> source = options.dataset.open();
    EngineOptions chosen = engineOptions(options, kind, source->metadata());
    options.engine.place(*source, chosen);
    const std::optional<Camera> given = options.cameraOver(source->metadata());
    requireWritable(out, options.force);

    const HeadlessContext context;
    requireRendererFeatures();
    const ShaderLibrary shaders = options.engine.shaders();
    // No memory for pixels until it is known how many are drawn at a time.
    Engine engine(*source, shaders, chosen, options.width, options.height, GridRect{0, 0, 1, 1});
    const double aspect = static_cast<double>(options.width) / options.height;
    const Camera camera =
        given ? *given : overviewCamera(source->metadata(), aspect, engine.earth(), chosen.exaggeration);
    const Drawn drawn = kind == PictureKind::png ? drawPng(engine, camera, options) : drawExr(engine, camera, options);
    const FrameReport& report = drawn.report;
    const std::string parts = drawn.parts > 1 ? " in " + std::to_string(drawn.parts) + " parts, each up to" : ",";
    std::printf("%s: %d x %d pixels%s %zu nodes from %zu height and %zu imagery tiles%s\n", out.c_str(), options.width,
                options.height, parts.c_str(), report.nodes, report.residentHeights, report.residentImagery,
                report.wanted > 0 ? ", and some tiles are lacking: the memory budget is too small" : "");
    if (report.coarsening != Coarsening())
        std::printf(
            "memory: --gpu-memory is too small for this view: tolerances were multiplied by %.2f (heights) and "
            "%.2f (photo)\n",
            report.coarsening.heights, report.coarsening.imagery);
    std::printf("earth: %s\n", engine.earth().description().c_str());
    if (engine.shading().mode != Shading::photo) std::printf("shading: %s\n", description(engine.shading()).c_str());
    return ExitCode::ok;
}

/// The arguments, those of a picture's JSON in place of --reproduce FILE; --size beside it counts.
Arguments reproduced(const Arguments& arguments) {
    const auto option = std::find(arguments.begin(), arguments.end(), "--reproduce");
    if (option == arguments.end()) return arguments;
    if (std::next(option) == arguments.end()) throw Error(ExitCode::usage, "--reproduce: expected FILE.json after it");
    static constexpr std::array<std::string_view, 1> kSize = {"size"};
    Arguments all = reproducingArguments(*std::next(option));
    if (gives(arguments, "size")) all = withoutOptions(all, kSize);
    all.insert(all.end(), arguments.begin(), option);
    all.insert(all.end(), option + 2, arguments.end());
    return all;
}

}  // namespace

ExitCode runView(const std::vector<std::string>& given) {
    const auto started = std::chrono::steady_clock::now();
    const Arguments arguments = reproduced(given);
    ViewOptions options;
    if (!options.parse(arguments)) return ExitCode::ok;
    return options.headless ? drawHeadless(options) : fly(options, arguments, started);
}

}  // namespace terray
