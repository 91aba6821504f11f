#include "client/view/snapshot.h"

#include <array>
#include <fstream>
#include <span>
#include <sstream>

#include "common/error.h"
#include "common/output_file.h"
#include "common/version.h"

namespace terray {
namespace {

constexpr const char* kFormat = "terray-picture";
constexpr int kVersion = 1;

/// Options that the window or the snapshot itself decides.
constexpr std::array<std::string_view, 7> kReplaced = {"camera",   "size",   "vsync",    "target-fps",
                                                       "pictures", "launch", "part-size"};

Arguments withoutFlag(Arguments arguments, std::string_view flag) {
    std::erase(arguments, flag);
    return arguments;
}

std::string required(const Result<std::string>& text) {
    if (!text) throw Error(ExitCode::georeference, "cannot take a picture: " + text.failure().message);
    return *text;
}

}  // namespace

Snapshot::Snapshot(Engine& engine, const Camera& camera, const SnapshotScene& scene, const std::filesystem::path& path)
    : path_(path) {
    // What the text says is drawn, not the camera itself, whose last digits it leaves out.
    const std::string text = required(formatCamera(camera, scene.projection));
    EngineOptions options = scene.settings.engine;
    options.render.launch = Launch::raster;
    options.features.statistics = false;
    engine.setOptions(options);
    picture_.emplace(engine, *parseCamera(text, scene.projection), path,
                     PictureInParts::Options{.size = scene.size, .part = scene.part});

    Arguments arguments = withoutFlag(withoutOptions(scene.arguments, kReplaced), "--full-screen");
    arguments = withOptions(withEngineTexts(arguments, scene.settings),
                            {{"camera", text},
                             {"size", std::to_string(scene.size.x) + "x" + std::to_string(scene.size.y)},
                             {"launch", "raster"}});
    Json list = Json::Array{};
    for (const std::string& argument : arguments) list.push(argument);
    const BuildInfo& build = buildInfo();
    json_ = Json::Object{{"format", kFormat},
                         {"version", kVersion},
                         {"tool", "terray-view " + std::string(build.version)},
                         {"commit", std::string(build.commit)},
                         {"content_hash", scene.source.contentHash()},
                         {"camera", text},
                         {"arguments", std::move(list)}};
}

void Snapshot::drawNext() {
    picture_->drawNext();
    if (!finished()) return;
    std::filesystem::path beside = path_;
    const std::string text = json_.dump() + "\n";
    writeWholeFile(beside.replace_extension(".json"), std::as_bytes(std::span(text)));
}

Arguments reproducingArguments(const std::filesystem::path& path) {
    const auto refuse = [&](const std::string& why) {
        return Error(ExitCode::input, path.string() + ": not the JSON beside a picture of terray-view: " + why);
    };
    std::ifstream file(path, std::ios::binary);
    if (!file) throw refuse("it cannot be read");
    std::ostringstream text;
    text << file.rdbuf();
    const auto json = Json::parse(text.str());
    if (!json) throw refuse(json.failure().message);
    const auto format = json->stringAt("format");
    const auto version = json->numberAt("version");
    if (!format || *format != kFormat || !version || *version != kVersion)
        throw refuse(std::string("expected format \"") + kFormat + "\" of version " + std::to_string(kVersion));
    const Json* list = json->find("arguments");
    if (list == nullptr || !list->isArray()) throw refuse("expected an array arguments");
    Arguments arguments{"--headless"};
    for (const Json& argument : list->array()) {
        if (!argument.isString()) throw refuse("expected texts in arguments");
        arguments.push_back(argument.string());
    }
    return arguments;
}

}  // namespace terray
