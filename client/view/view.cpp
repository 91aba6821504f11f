#include "client/view/view.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>

#include <glm/common.hpp>

#include "client/engine/dataset_camera.h"
#include "client/engine/dataset_options.h"
#include "client/engine/engine.h"
#include "client/engine/engine_options.h"
#include "client/engine/program.h"
#include "client/output/picture.h"
#include "client/render/gl_context.h"
#include "client/stream/camera.h"
#include "common/command_line.h"
#include "common/output_file.h"

namespace terray {
namespace {

enum class PictureKind { png, exr };

struct ViewOptions {
    DatasetCommandLine dataset;
    bool headless = false;
    std::string camera;
    int width = 1280;
    int height = 720;
    std::string out;
    bool force = false;
    EngineCommandLine engine;
};

bool parse(ViewOptions& options, const std::vector<std::string>& arguments) {
    CommandLine line("terray-view", "Draws one picture of a dataset, when all of its tiles are loaded.");
    options.dataset.declare(line);
    line.flag("--headless", options.headless, "draw without a window");
    line.option("--camera", options.camera, "LON,LAT,HEIGHT,HEADING,PITCH[,FOV]",
                "degrees and metres; X,Y instead of LON,LAT where the dataset has no coordinate system or this build "
                "no PROJ (an overview of the whole dataset)");
    line.size("--size", options.width, options.height, "of the picture in pixels (1280x720)");
    line.option("--out", options.out, "FILE.png|FILE.exr", "where the picture goes");
    line.flag("--force", options.force, "replace an existing picture");
    options.engine.declare(line);
    return line.parse(arguments);
}

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

/// The camera that was given, if one was.
std::optional<Camera> cameraOf(const ViewOptions& options, const DatasetMetadata& metadata) {
    const std::optional<Projection> projection = projectionOf(metadata);
    if (options.camera.empty()) return {};
    Result<Camera> camera = parseCamera(options.camera, projection ? &*projection : nullptr);
    if (!camera) throw Error(ExitCode::usage, "--camera: " + camera.failure().message);
    return *camera;
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

}  // namespace

ExitCode runView(const std::vector<std::string>& arguments) {
    ViewOptions options;
    if (!parse(options, arguments)) return ExitCode::ok;
    if (!options.headless)
        throw Error(ExitCode::unsupported, "the window arrives with a later version: give --headless and --out");
    if (options.out.empty()) throw Error(ExitCode::usage, "--headless needs --out FILE.png or FILE.exr");
    const std::filesystem::path out = options.out;
    const PictureKind kind = kindOf(out);

    const std::unique_ptr<TileSource> source = options.dataset.open();
    EngineOptions chosen = engineOptions(options, kind, source->metadata());
    options.engine.place(*source, chosen);
    const std::optional<Camera> given = cameraOf(options, source->metadata());
    requireWritable(out, options.force);

    const HeadlessContext context;
    requireRendererFeatures();
    const ShaderLibrary shaders = options.engine.shaders();
    Engine engine(*source, shaders, chosen, options.width, options.height);
    const double aspect = static_cast<double>(options.width) / options.height;
    const Camera camera =
        given ? *given : overviewCamera(source->metadata(), aspect, engine.earth(), chosen.exaggeration);
    const FrameReport report = engine.drawFrame(camera, true);
    requireAllTiles(report, "no picture was written");
    throwIfInterrupted();
    if (kind == PictureKind::png) {
        writePng(out, engine.targets().readSrgb().view());
    } else {
        writeExr(out, measure(engine, camera));
    }
    std::printf("%s: %d x %d pixels, %zu nodes from %zu height and %zu imagery tiles%s\n", out.c_str(), options.width,
                options.height, report.nodes, report.residentHeights, report.residentImagery,
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

}  // namespace terray
