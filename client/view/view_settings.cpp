#include "client/view/view_settings.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include <glm/common.hpp>

#include "client/engine/engine_options.h"

namespace terray {
namespace {

/// Every option that engineTexts() may say, and those that make no sense beside others of them.
constexpr std::array<std::string_view, 11> kOwnOptions = {
    "tolerance",    "shading", "contour-interval", "surface", "shadows", "sun", "sun-time",
    "exaggeration", "earth",   "visual-range",     "sky"};
/// Options of the window that are remembered beside them.
constexpr std::array<std::string_view, 2> kWindowOptions = {"vsync", "target-fps"};

std::string timeText(UtcTime time) {
    const auto day = std::chrono::floor<std::chrono::days>(time);
    const std::chrono::year_month_day date(day);
    const auto minutes = std::chrono::floor<std::chrono::minutes>(time - day).count();
    std::array<char, 40> text{};
    std::snprintf(text.data(), text.size(), "%04d-%02u-%02uT%02d:%02dZ", static_cast<int>(date.year()),
                  static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                  static_cast<int>(minutes / 60), static_cast<int>(minutes % 60));
    return text.data();
}

const char* surfaceText(Surface surface) {
    return surface == Surface::columns ? "columns" : surface == Surface::bilinear ? "bilinear" : "auto";
}

const char* earthText(EarthShape shape) {
    return shape == EarthShape::flat ? "flat" : shape == EarthShape::curved ? "curved" : "auto";
}

std::string_view shadingText(Shading shading) {
    return std::find_if(kShadingModes.begin(), kShadingModes.end(),
                        [&](const ShadingMode& mode) { return mode.shading == shading; })
        ->name;
}

}  // namespace

UtcTime SunSetting::time() const {
    using namespace std::chrono;
    year_month_day date{std::chrono::year(year) / month / day};
    if (!date.ok()) date = std::chrono::year(year) / month / last;  // the 31st of a shorter month
    return sys_days(date) + minutes(minute);
}

void SunSetting::setTime(UtcTime time) {
    const auto today = std::chrono::floor<std::chrono::days>(time);
    const std::chrono::year_month_day date(today);
    year = static_cast<int>(date.year());
    month = static_cast<int>(static_cast<unsigned>(date.month()));
    day = static_cast<int>(static_cast<unsigned>(date.day()));
    minute = static_cast<int>(std::chrono::floor<std::chrono::minutes>(time - today).count());
}

std::string SunSetting::text() const {
    return numberText(azimuthDegrees) + "," + numberText(elevationDegrees);
}

void ViewSettings::settle() {
    engine.sunTime.reset();
    if (sun.byTime && canTellTime) {
        engine.sunTime = sun.time();
    } else {
        engine.render.sunDirection = sunDirection(sun.text());
    }
    if (engine.render.shading.mode == Shading::shadowSteps && !engine.render.shadows)
        engine.render.shadows = ShadowOptions();
    engine.features.statistics = countSteps;
}

glm::ivec2 pictureSize(PictureSize size, glm::ivec2 window) {
    constexpr int kWide = 16384;
    const int longer = std::max(window.x, window.y);
    const double wanted = size == PictureSize::wide        ? double{kWide} / longer
                          : size == PictureSize::fourTimes ? 4
                          : size == PictureSize::twice     ? 2
                                                           : 1;
    // No picture is larger than 16384 but one of a window that is.
    const double factor = std::min(wanted, std::max(double{kWide} / longer, 1.0));
    return glm::max(glm::ivec2(glm::round(factor * glm::dvec2(window))), 1);
}

ViewSettings settingsFrom(const EngineOptions& options, const DatasetMetadata& metadata) {
    ViewSettings settings{.engine = options,
                          .canTellTime = !metadata.crsWkt.empty() && TERRAY_WITH_PROJ,
                          .hasPhoto = metadata.imageryLevel.has_value() && options.selection.useImagery};
    const glm::dvec3& sun = options.render.sunDirection;
    // To 0.1 degrees, so that texts stay short; the default direction is 315, 40 within that.
    const auto degrees = [](double radians) { return std::round(radians * 1800 / std::numbers::pi) / 10; };
    settings.sun.azimuthDegrees = degrees(std::atan2(sun.x, sun.y) + (sun.x < 0 ? 2 * std::numbers::pi : 0));
    settings.sun.elevationDegrees = degrees(std::atan2(sun.z, std::hypot(sun.x, sun.y)));
    if (options.sunTime) settings.sun.setTime(*options.sunTime);
    settings.sun.byTime = options.sunTime.has_value();
    settings.settle();
    return settings;
}

OptionTexts engineTexts(const ViewSettings& settings) {
    const EngineOptions& engine = settings.engine;
    OptionTexts texts{
        {"tolerance", numberText(engine.selection.tolerance.value())},
        {"shading", std::string(shadingText(engine.render.shading.mode))},
        {"surface", surfaceText(engine.render.surface)},
        {"shadows", engine.render.shadows ? "on" : "off"},
        {"exaggeration", numberText(engine.exaggeration)},
        {"earth", earthText(engine.earth.shape)},
        {"visual-range", engine.render.visualRange ? numberText(engine.render.visualRange->value()) : "off"},
        {"sky", engine.render.sky ? "physical" : "gradient"}};
    if (engine.sunTime) {
        texts.emplace_back("sun-time", timeText(*engine.sunTime));
    } else {
        texts.emplace_back("sun", settings.sun.text());
    }
    return texts;
}

Arguments withEngineTexts(const Arguments& arguments, const ViewSettings& settings) {
    return withOptions(withoutOptions(arguments, kOwnOptions), engineTexts(settings));
}

Json toJson(const ViewSettings& settings) {
    Json options = Json::Object{};
    for (const auto& [name, value] : engineTexts(settings)) options.set(name, value);
    options.set("vsync", settings.vsync ? "on" : "off");
    options.set("target-fps", numberText(settings.targetFps));
    return Json::Object{{"format", "terray-view-settings"}, {"version", 1},
                        {"options", std::move(options)},    {"picture_size", static_cast<int>(settings.pictureSize)},
                        {"panel", settings.panel},          {"instruments", settings.instruments}};
}

Arguments withRemembered(const Json& remembered, const Arguments& arguments, bool canTellTime) {
    const Json* options = remembered.find("options");
    if (options == nullptr || !options->isObject()) return arguments;
    const bool sunGiven = gives(arguments, "sun") || gives(arguments, "sun-time");
    OptionTexts texts;
    for (const auto& [name, value] : options->object()) {
        const auto is = [&](std::string_view own) { return own == name; };
        const bool known = std::any_of(kOwnOptions.begin(), kOwnOptions.end(), is) ||
                           std::any_of(kWindowOptions.begin(), kWindowOptions.end(), is);
        const bool sun = name == "sun" || name == "sun-time";
        if (!known || !value.isString() || gives(arguments, name) || (sun && sunGiven)) continue;
        if (name == "sun-time" && !canTellTime) continue;
        texts.emplace_back(name, value.string());
    }
    return withOptions(arguments, texts);
}

void restorePanels(const Json& remembered, ViewSettings& settings) {
    if (const auto size = remembered.numberAt("picture_size"); size && *size >= 0 && *size < kPictureSizes.size())
        settings.pictureSize = static_cast<PictureSize>(*size);
    settings.panel = remembered.boolAt("panel").ok() ? *remembered.boolAt("panel") : settings.panel;
    settings.instruments =
        remembered.boolAt("instruments").ok() ? *remembered.boolAt("instruments") : settings.instruments;
}

std::optional<std::filesystem::path> configFolder() {
    if (const char* folder = std::getenv("XDG_CONFIG_HOME"); folder != nullptr && *folder == '/')
        return std::filesystem::path(folder) / "terray";
    if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/')
        return std::filesystem::path(home) / ".config" / "terray";
    return {};
}

}  // namespace terray
