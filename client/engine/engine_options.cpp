#include "client/engine/engine_options.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string_view>

#include "client/engine/dataset_camera.h"
#include "client/stream/edits_file.h"
#include "common/error.h"
#include "common/parse_number.h"
#include "common/sun_position.h"
#include "common/units.h"

namespace terray {
namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& found, const std::string& expected) {
    throw Error(ExitCode::usage, option + ": found \"" + found + "\", expected " + expected);
}

std::string shortText(double value) {
    return Json(value).dump();
}

void requireRange(const std::string& option, double value, double least, double most) {
    if (value < least || value > most)
        refuse(option, shortText(value), "a number from " + shortText(least) + " to " + shortText(most));
}

std::string degreesOf(const glm::dvec3& sun) {
    const double azimuth = degreesFromRadians(Radians(std::atan2(sun.x, sun.y)));
    const double elevation = degreesFromRadians(Radians(std::atan2(sun.z, std::hypot(sun.x, sun.y))));
    char text[64];
    std::snprintf(text, sizeof(text), "%.1f,%.1f", azimuth < 0 ? azimuth + 360 : azimuth, elevation);
    return text;
}

/// The names of a table's entries, one after the other.
template <class Table>
std::string namesOf(const Table& table, const char* between) {
    std::string names;
    for (const auto& entry : table) names += (names.empty() ? "" : between) + std::string(entry.name);
    return names;
}

UtcTime sunTime(const std::string& text, bool sunGiven) {
    if (sunGiven) throw Error(ExitCode::usage, "--sun and --sun-time both say where the sun is: give one of them");
    const Result<UtcTime> time = parseUtcTime(text);
    if (!time.ok()) throw Error(ExitCode::usage, "--sun-time: " + time.failure().message);
    return *time;
}

}  // namespace

glm::dvec3 sunDirection(const std::string& azimuthAndElevation) {
    const std::string_view text = azimuthAndElevation;
    const size_t comma = text.find(',');
    std::optional<double> azimuth;
    std::optional<double> elevation;
    if (comma != std::string_view::npos) {
        azimuth = parseNumber(text.substr(0, comma));
        elevation = parseNumber(text.substr(comma + 1));
    }
    if (!azimuth || !elevation || std::abs(*elevation) > 90)
        refuse("--sun", azimuthAndElevation, "AZIMUTH,ELEVATION in degrees, the elevation from -90 to 90");
    return directionOf({.azimuth = radiansFromDegrees(*azimuth), .elevation = radiansFromDegrees(*elevation)});
}

std::optional<Metres> visualRangeNamed(const std::string& text) {
    constexpr double kLeast = 1e3;
    constexpr double kMost = 3e5;
    if (text == "off") return {};
    const std::optional<double> metres = parseNumber(text);
    if (!metres || *metres < kLeast || *metres > kMost)
        refuse("--visual-range", text, "off, or metres from " + shortText(kLeast) + " to " + shortText(kMost));
    return Metres(*metres);
}

PhotoFilter photoFilter(const std::string& name) {
    if (name == "auto") return PhotoFilter::automatic;
    if (name == "hardware") return PhotoFilter::hardware;
    if (name == "probes") return PhotoFilter::probes;
    refuse("--photo-filter", name, "auto, hardware or probes");
}

Launch launchNamed(const std::string& name) {
    if (name == "auto") return Launch::automatic;
    if (name == "raster") return Launch::raster;
    if (name == "compute") return Launch::compute;
    refuse("--launch", name, "auto, raster or compute");
}

Surface surfaceNamed(const std::string& name) {
    if (name == "auto") return Surface::automatic;
    if (name == "columns") return Surface::columns;
    if (name == "bilinear") return Surface::bilinear;
    refuse("--surface", name, "auto, columns or bilinear");
}

Shading shadingNamed(const std::string& name) {
    for (const ShadingMode& mode : kShadingModes)
        if (mode.name == name) return mode.shading;
    refuse("--shading", name, "one of " + namesOf(kShadingModes, ", "));
}

EarthShape earthShapeNamed(const std::string& name) {
    if (name == "auto") return EarthShape::automatic;
    if (name == "flat") return EarthShape::flat;
    if (name == "curved") return EarthShape::curved;
    refuse("--earth", name, "auto, flat or curved");
}

void EngineCommandLine::declare(CommandLine& line) {
    sun_ = degreesOf(RenderOptions().sunDirection);
    line.option("--tolerance", tolerance_, "PIXELS", "largest projected error of drawn heights (2/3)");
    line.option(
        "--lod-distance", lodDistance_, "SAMPLES",
        "of heights by distance in place of a tolerance, as paper 000 has it: the finest up to so many of their "
        "samples away, half as fine at each doubling");
    line.option("--imagery-tolerance", imageryTolerance_, "PIXELS", "largest projected side of a photo's texel (1)");
    line.flag("--no-imagery", noImagery_, "ignore the dataset's photo");
    line.option("--sun", sun_, "AZIMUTH,ELEVATION", "degrees from grid north and above the horizon (" + sun_ + ")")
        .given(sunGiven_);
    line.option("--sun-time", sunTime_, "TIME",
                "the sun of that moment over the camera instead, as 2026-06-21T12:00Z or with an offset as +02:00");
    line.option("--sky", sky_, "gradient|physical",
                "physical: by the sun's elevation and the eye's height, with its light on the ground (gradient)");
    line.option("--visual-range", visualRange_, "METRES|off",
                "aerial perspective: how far a black mountain at sea level is told from the sky (off)");
    line.option("--anisotropy", anisotropy_, "RATIO", "of photo sampling, 1 to 16 (16)");
    line.option("--photo-filter", photoFilter_, "auto|hardware|probes",
                "who filters photos anisotropically: auto takes probes in the shader on software rasterisers (auto)");
    line.bytes("--host-memory", hostMemory_, "for decoded tiles in main memory (1G)");
    line.bytes("--gpu-memory", gpuMemory_,
               "for tiles on the GPU, half to heights and half to the photo; all to heights without a photo (512M)");
    line.bytes("--upload-budget", uploadBudget_, "of one frame, at least one tile; not while waiting for tiles (16M)");
    line.option("--upload-share", uploadShare_, "FACTOR",
                "time that a frame gives to uploads over what the rest of it takes, 0 to 10; at least one tile (0.5)");
    line.option("--decode-threads", decodeThreads_, "N", "0: one less than the machine's cores (0)");
    line.option("--prefetch", prefetch_, "on|off",
                "read ahead along the camera's motion, while nothing wanted is to be read (on)");
    line.option("--cancel-reads", cancelReads_, "on|off", "from a server: break off what is no longer wanted (on)");
    line.option("--launch", launch_, "auto|raster|compute",
                "rays from rasterised boxes or from dispatches alone; auto times both at the start (auto)");
    line.option("--occlusion", occlusion_, "on|off", "raster launch: the tile-ID pass ahead of the march (on)");
    line.option("--surface", surface_, "auto|columns|bilinear",
                "between samples; auto: bilinear where a sample is larger than a pixel, else columns (auto)");
    line.option("--exaggeration", exaggeration_, "FACTOR", "of all heights, the camera's among them, 0.01 to 100 (1)");
    line.option("--earth", earth_, "auto|flat|curved",
                "auto: curved where that moves ground by more than --tolerance across the dataset: beyond about "
                "11 km at 720 rows, and only with a coordinate system (auto)");
    line.option("--refraction", refraction_, "K",
                "by which part of the earth's curvature air bends light, -5 to 0.99; 0: none (0.13)");
    line.option("--method", method_, "NAME[:KEY=VALUE,...]",
                "how the visible surface is found: " + namesOf(kMethods, "|") +
                    "; client/README.md has the numbers that each may be given (pyramid)");
    line.option(
        "--draw-costs", drawCosts_, "FILE",
        "what --method hybrid chooses by on this machine: read, or measured and written there when it is missing "
        "or other graphics have written it (measured at each start)");
    line.option("--shadows", shadows_, "on|off", "cast by the ground, tiles outside the picture included (off)");
    line.option("--sun-diameter", sunDiameter_, "DEGREES",
                "of the sun's disc, for soft shadows; the sun's is 0.53 (0)");
    line.option("--shadow-rays", shadowRays_, "N", "of each pixel when the sun has a diameter, 1 to 64 (8)");
    line.option("--edits", edits_, "FILE.json", "craters and brush strokes on the ground; the dataset stays as it is");
    line.option("--shading", shading_, "MODE", "what the ground shows: " + namesOf(kShadingModes, "|") + " (photo)");
    line.option("--contour-interval", contourInterval_, "METRES",
                "between contour lines, 0.01 to 10000 (1, 2 or 5 times a power of ten, for at least 20 lines)");
    overlay_.declare(line);
    line.option("--shaders", shaders_, "DIR", "take shader sources from here before those built in");
    line.flag("--signal-sky", signalSky_, "magenta instead of sky, to find pixels without ground");
}

EngineOptions EngineCommandLine::options(bool datasetHasImagery) const {
    constexpr double kMostPixels = 1e6;
    requireRange("--tolerance", tolerance_, 1e-3, kMostPixels);
    requireRange("--imagery-tolerance", imageryTolerance_, 1e-3, kMostPixels);
    requireRange("--anisotropy", anisotropy_, 1, 16);
    requireRange("--exaggeration", exaggeration_, kLeastExaggeration, kGreatestExaggeration);
    requireRange("--decode-threads", static_cast<double>(decodeThreads_), 0, 1024);
    requireRange("--upload-share", uploadShare_, 0, 10);
    requireRange("--refraction", refraction_, -5, 0.99);
    requireRange("--sun-diameter", sunDiameter_, 0, 20);
    requireRange("--shadow-rays", static_cast<double>(shadowRays_), 1, 64);
    if (shadows_ != "on" && shadows_ != "off") refuse("--shadows", shadows_, "on or off");
    if (!shaders_.empty() && !std::filesystem::is_directory(shaders_)) refuse("--shaders", shaders_, "a directory");
    if (sky_ != "gradient" && sky_ != "physical") refuse("--sky", sky_, "gradient or physical");
    if (prefetch_ != "on" && prefetch_ != "off") refuse("--prefetch", prefetch_, "on or off");
    if (cancelReads_ != "on" && cancelReads_ != "off") refuse("--cancel-reads", cancelReads_, "on or off");
    if (occlusion_ != "on" && occlusion_ != "off") refuse("--occlusion", occlusion_, "on or off");

    EngineOptions options;
    options.render.shading = shading();
    options.selection.tolerance = Pixels(tolerance_);
    if (lodDistance_) requireRange("--lod-distance", *lodDistance_, 1, 1e9);
    options.selection.lodDistance = lodDistance_;
    options.selection.imageryTolerance = Pixels(imageryTolerance_);
    options.selection.useImagery = datasetHasImagery && !noImagery_ && needsOf(options.render.shading.mode).photoTiles;
    options.render.sunDirection = sunDirection(sun_);
    if (!sunTime_.empty()) options.sunTime = sunTime(sunTime_, sunGiven_);
    options.render.sky = sky_ == "physical";
    options.render.visualRange = visualRangeNamed(visualRange_);
    options.render.anisotropy = static_cast<float>(anisotropy_);
    options.render.photoFilter = photoFilter(photoFilter_);
    options.render.method = methodNamed(method_);
    options.render.launch = launchNamed(launch_);
    if (options.render.launch == Launch::compute && entryOf(options.render.method.method).geometry)
        refuse("--launch", launch_, "auto or raster: --method " + method_ + " rasterises geometry of its own");
    options.render.occlusion = occlusion_ == "on";
    options.render.surface = surfaceNamed(surface_);
    options.earth = {.shape = earthShapeNamed(earth_), .refraction = refraction_};
    if (shadows_ == "on") {
        options.render.shadows = ShadowOptions{.sunDiameter = radiansFromDegrees(sunDiameter_).value(),
                                               .rays = static_cast<int>(shadowRays_)};
    }
    options.drawCostsFile = drawCosts_;
    options.pager.hostBudgetBytes = hostMemory_;
    options.pager.decodeThreads = static_cast<int>(decodeThreads_);
    options.pager.cancelReads = cancelReads_ == "on";
    options.prefetch = prefetch_ == "on";
    options.gpuImageryBytes = options.selection.useImagery ? gpuMemory_ / 2 : 0;
    options.gpuHeightBytes = gpuMemory_ - options.gpuImageryBytes;
    options.uploadBytesPerFrame = uploadBudget_;
    options.uploadShare = uploadShare_;
    options.features.signalSky = signalSky_;
    options.exaggeration = exaggeration_;
    return options;
}

ShadingOptions EngineCommandLine::shading() const {
    ShadingOptions shading{.mode = shadingNamed(shading_)};
    if (shading.mode == Shading::shadowSteps && shadows_ != "on")
        throw Error(ExitCode::usage, "--shading shadow-steps: found no shadow rays to count, expected --shadows on");
    if (contourInterval_ && shading.mode != Shading::contours)
        throw Error(ExitCode::usage,
                    "--contour-interval: found --shading " + shading_ + ", expected --shading contours");
    if (contourInterval_) {
        requireRange("--contour-interval", *contourInterval_, 0.01, 1e4);
        shading.contourInterval = Metres(*contourInterval_);
    }
    return shading;
}

Json EngineCommandLine::toJson() const {
    return Json::Object{{"tolerance", tolerance_},
                        {"lod-distance", lodDistance_ ? Json(*lodDistance_) : Json()},
                        {"imagery-tolerance", imageryTolerance_},
                        {"no-imagery", noImagery_},
                        {"sun", sunTime_.empty() ? Json(sun_) : Json()},
                        {"sun-time", sunTime_.empty() ? Json() : Json(sunTime_)},
                        {"sky", sky_},
                        {"visual-range", visualRange_},
                        {"anisotropy", anisotropy_},
                        {"photo-filter", photoFilter_},
                        {"host-memory", hostMemory_},
                        {"gpu-memory", gpuMemory_},
                        {"upload-budget", uploadBudget_},
                        {"upload-share", uploadShare_},
                        {"decode-threads", decodeThreads_},
                        {"prefetch", prefetch_},
                        {"cancel-reads", cancelReads_},
                        {"launch", launch_},
                        {"occlusion", occlusion_},
                        {"surface", surface_},
                        {"method", method_},
                        {"draw-costs", drawCosts_.empty() ? Json() : Json(drawCosts_)},
                        {"shadows", shadows_},
                        {"sun-diameter", sunDiameter_},
                        {"shadow-rays", shadowRays_},
                        {"exaggeration", exaggeration_},
                        {"earth", earth_},
                        {"refraction", refraction_},
                        {"edits", edits_.empty() ? Json() : Json(edits_)},
                        {"shading", shading_},
                        {"contour-interval", contourInterval_ ? Json(*contourInterval_) : Json()},
                        {"overlay", overlay_.toJson()},
                        {"shaders", shaders_.empty() ? Json() : Json(shaders_)},
                        {"signal-sky", signalSky_}};
}

void EngineCommandLine::place(const TileSource& source, EngineOptions& options) const {
    if (!edits_.empty()) {
        const std::optional<Projection> projection = projectionOf(source.metadata());
        options.edits = loadEdits(edits_, projection ? &*projection : nullptr);
    }
    options.overlay = overlay_.meshes(source, options.edits);
}

ShaderLibrary EngineCommandLine::shaders() const {
    return shaders_.empty() ? ShaderLibrary() : ShaderLibrary(shaders_);
}

}  // namespace terray
