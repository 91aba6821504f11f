#include "client/engine/draw_costs_file.h"

#include <fstream>
#include <optional>
#include <span>
#include <sstream>
#include <string>

#include "client/render/draw_calibration.h"
#include "client/render/gl_objects.h"
#include "common/error.h"
#include "common/output_file.h"

namespace terray {
namespace {

constexpr const char* kFormat = "terray-draw-costs";
constexpr int kVersion = 2;

struct NamedCost {
    const char* name;
    double DrawCosts::*cost;
};
constexpr NamedCost kCosts[] = {
    {"cast_node_ms", &DrawCosts::castNode},   {"cast_pixel_ms", &DrawCosts::castPixel},
    {"cast_step_ms", &DrawCosts::castStep},   {"mesh_node_ms", &DrawCosts::meshNode},
    {"mesh_pixel_ms", &DrawCosts::meshPixel}, {"mesh_triangle_ms", &DrawCosts::meshTriangle},
    {"mesh_make_ms", &DrawCosts::meshMake}};

std::string currentGraphics() {
    std::string text;
    for (const GLenum name : {GL_RENDERER, GL_VERSION})
        text += (text.empty() ? "" : ", ") + std::string(reinterpret_cast<const char*>(glGetString(name)));
    return text;
}

/// None when other graphics or an earlier version of this program have written it.
std::optional<DrawCosts> read(const std::filesystem::path& file, const std::string& graphics) {
    const auto refuse = [&](const std::string& why) {
        return Error(ExitCode::input, "cannot read what drawing costs from " + file.string() + ": " + why +
                                          "; remove the file and it is measured and written anew");
    };
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    if (!stream || !text) throw refuse("it cannot be opened, or is empty");
    const auto json = Json::parse(text.str());
    if (!json) throw refuse(json.failure().message);
    const auto format = json->stringAt("format");
    const auto version = json->numberAt("version");
    if (!format || *format != kFormat || !version || *version > kVersion)
        throw refuse(std::string("expected \"format\": \"") + kFormat + "\", \"version\": " + std::to_string(kVersion));
    if (*version < kVersion) return std::nullopt;
    const auto made = json->stringAt("graphics");
    if (!made || *made != graphics) return std::nullopt;
    DrawCosts costs;
    for (const NamedCost& named : kCosts) {
        const auto cost = json->numberAt(named.name);
        if (!cost) throw refuse(cost.failure().message);
        if (*cost < 0) throw refuse(std::string("\"") + named.name + "\" is below 0");
        costs.*named.cost = *cost;
    }
    return costs;
}

void write(const std::filesystem::path& file, const std::string& graphics, const DrawCosts& costs) {
    Json json = toJson(costs);
    json.set("format", kFormat);
    json.set("version", kVersion);
    json.set("graphics", graphics);
    const std::string text = json.dump(2) + "\n";
    writeWholeFile(file, std::as_bytes(std::span(text)));
}

}  // namespace

Json toJson(const DrawCosts& costs) {
    Json json = Json::Object{};
    for (const NamedCost& named : kCosts) json.set(named.name, costs.*named.cost);
    return json;
}

DrawCosts settledDrawCosts(const std::filesystem::path& file, const ShaderLibrary& shaders) {
    const std::string graphics = currentGraphics();
    if (!file.empty() && std::filesystem::exists(file))
        if (const auto costs = read(file, graphics)) return *costs;
    const DrawCosts costs = calibratedCosts(shaders);
    if (!file.empty()) write(file, graphics, costs);
    return costs;
}

}  // namespace terray
