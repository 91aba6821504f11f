#include "client/view/fly.h"

#if TERRAY_WITH_WINDOW

#include <array>
#include <cctype>
#include <cstdio>
#include <fstream>
#include <memory>
#include <span>
#include <sstream>

#include "client/view/viewer.h"
#include "common/output_file.h"

namespace terray {
namespace {

/// The last part of a directory or an address, for the window's title.
std::string nameOf(std::string place) {
    while (place.size() > 1 && place.ends_with('/')) place.pop_back();
    return place.substr(place.rfind('/') + 1);
}

/// What was remembered; null when nothing, or nothing that can be read, was.
Json remembered(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    auto json = Json::parse(text.str());
    return json ? std::move(*json) : Json();
}

/// The arguments with what was remembered of options that they do not give; as they are where that does not fit.
Arguments completed(const Json& json, const Arguments& arguments, const DatasetMetadata& metadata) {
    try {
        const Arguments all = withRemembered(json, arguments, !metadata.crsWkt.empty() && TERRAY_WITH_PROJ);
        ViewOptions options;
        if (options.parse(all)) (void)options.engine.options(metadata.imageryLevel.has_value());
        return all;
    } catch (const Error& error) {
        std::fprintf(stderr, "terray-view: remembered settings are left out: %s\n", error.what());
        return arguments;
    }
}

/// What the engine begins with: memory for photos even where the first shading shows none, so that another may.
EngineOptions engineOptions(const Arguments& arguments, bool hasImagery) {
    static constexpr std::array<std::string_view, 2> kShading = {"shading", "contour-interval"};
    ViewOptions shaded, plain;
    if (!shaded.parse(arguments) || !plain.parse(withoutOptions(arguments, kShading))) return {};
    EngineOptions options = plain.engine.options(hasImagery);
    options.render.shading = shaded.engine.options(hasImagery).render.shading;
    return options;
}

void remember(const ViewSettings& settings, const std::filesystem::path& path) {
    try {
        std::error_code ignored;  // what is wrong with the folder shows when the file is written
        std::filesystem::create_directories(path.parent_path(), ignored);
        const std::string text = toJson(settings).dump() + "\n";
        writeWholeFile(path, std::as_bytes(std::span(text)));
    } catch (const Error& error) {
        std::fprintf(stderr, "terray-view: settings are not remembered: %s\n", error.what());
    }
}

std::string asFileName(std::string text) {
    for (char& letter : text)
        if (std::isalnum(static_cast<unsigned char>(letter)) == 0) letter = '-';
    return text;
}

void printStart(const Viewer& viewer) {
    if (viewer.firstPictureMs()) std::printf("first picture after %.0f ms", *viewer.firstPictureMs());
    if (viewer.fullDetailMs()) std::printf(", all its tiles after %.0f ms", *viewer.fullDetailMs());
    std::printf("\n");
}

}  // namespace

ExitCode fly(const ViewOptions& given, const Arguments& arguments, std::chrono::steady_clock::time_point started) {
    if (!given.out.empty())
        throw Error(ExitCode::usage, "--out: found no --headless, expected it (in the window P writes a picture)");
    const std::unique_ptr<TileSource> source = given.dataset.open();
    const DatasetMetadata& metadata = source->metadata();
    const std::optional<std::filesystem::path> config = configFolder();
    const Json json = config ? remembered(*config / "view.json") : Json();
    const Arguments all = completed(json, arguments, metadata);
    ViewOptions options;
    if (!options.parse(all)) return ExitCode::ok;

    ViewerOptions viewing;
    viewing.datasetName = nameOf(options.dataset.place());
    viewing.arguments = arguments;
    viewing.remembered = json;
    viewing.pictures = options.pictures;
    viewing.part = options.partSize();
    viewing.targetFps = options.targetFps;
    viewing.window.title = viewing.datasetName + " - Terray";
    viewing.window.width = options.width;
    viewing.window.height = options.height;
    viewing.window.vsync = options.vsync == "on";
    viewing.engine = engineOptions(all, metadata.imageryLevel.has_value());
    viewing.camera = options.cameraOver(metadata);
    viewing.started = started;
    if (config) viewing.bookmarks = *config / "bookmarks" / (asFileName(source->contentHash()) + ".json");
    options.engine.place(*source, viewing.engine);
    const ShaderLibrary shaders = options.engine.shaders();

    Viewer viewer(*source, shaders, viewing);
    viewer.window().setFullScreen(options.fullScreen);
    viewer.run();
    printStart(viewer);
    if (config) remember(viewer.settings(), *config / "view.json");
    return ExitCode::ok;
}

}  // namespace terray

#else

namespace terray {

ExitCode fly(const ViewOptions&, const Arguments&, std::chrono::steady_clock::time_point) {
    throw Error(ExitCode::unsupported,
                "this build has no window (configured with TERRAY_WITH_WINDOW=OFF): give --headless and --out");
}

}  // namespace terray

#endif
