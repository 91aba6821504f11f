#include "client/view/panel.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include <imgui.h>

namespace terray {
namespace {

/// A slider over a double. @param format  as printf's
bool slider(const char* label, double& value, double least, double most, const char* format,
            ImGuiSliderFlags flags = ImGuiSliderFlags_AlwaysClamp) {
    return ImGui::SliderScalar(label, ImGuiDataType_Double, &value, &least, &most, format,
                               flags | ImGuiSliderFlags_AlwaysClamp);
}

template <class Value, size_t count>
bool choice(const char* label, Value& value, const std::array<const char*, count>& names) {
    int index = static_cast<int>(value);
    const bool changed = ImGui::Combo(label, &index, names.data(), static_cast<int>(count));
    value = static_cast<Value>(index);
    return changed;
}

bool shadingChoice(Shading& shading) {
    bool changed = false;
    const auto& now = kShadingModes.at(static_cast<size_t>(shading));
    if (!ImGui::BeginCombo("shading", now.name.data())) return false;
    for (const ShadingMode& mode : kShadingModes)
        if (ImGui::Selectable(mode.name.data(), mode.shading == shading)) {
            shading = mode.shading;
            changed = true;
        }
    ImGui::EndCombo();
    return changed;
}

bool sunControls(SunSetting& sun, bool canTellTime) {
    bool changed = false;
    if (canTellTime) changed |= ImGui::Checkbox("by date and time (UTC)", &sun.byTime);
    if (sun.byTime && canTellTime) {
        std::array<int, 3> date{sun.year, sun.month, sun.day};
        if (ImGui::InputInt3("date", date.data())) {
            sun.year = std::min(std::max(date[0], 1900), 2100);
            sun.month = std::min(std::max(date[1], 1), 12);
            sun.day = std::min(std::max(date[2], 1), 31);
            changed = true;
        }
        std::array<char, 24> hour{};
        std::snprintf(hour.data(), hour.size(), "%02d:%02d", sun.minute / 60, sun.minute % 60);
        changed |= ImGui::SliderInt("time of day", &sun.minute, 0, 24 * 60 - 1, hour.data());
        return changed;
    }
    changed |= slider("azimuth", sun.azimuthDegrees, 0, 360, "%.1f deg");
    changed |= slider("elevation", sun.elevationDegrees, -10, 90, "%.1f deg");
    return changed;
}

bool lightControls(ViewSettings& settings) {
    RenderOptions& render = settings.engine.render;
    bool changed = sunControls(settings.sun, settings.canTellTime);
    bool shadows = render.shadows.has_value();
    if (ImGui::Checkbox("shadows", &shadows)) {
        render.shadows = shadows ? std::optional(ShadowOptions()) : std::nullopt;
        changed = true;
    }
    ImGui::SameLine();
    changed |= ImGui::Checkbox("sky of the sun's height", &render.sky);
    bool haze = render.visualRange.has_value();
    double kilometres = render.visualRange.value_or(Metres(60000)).value() / 1000;
    const bool toggled = ImGui::Checkbox("haze", &haze);
    bool moved = false;
    if (haze) moved = slider("visual range", kilometres, 1, 300, "%.0f km", ImGuiSliderFlags_Logarithmic);
    if (toggled || moved) render.visualRange = haze ? std::optional(Metres(1000 * kilometres)) : std::nullopt;
    return changed || toggled || moved;
}

bool groundControls(ViewSettings& settings) {
    static constexpr std::array<const char*, 3> kSurfaces = {"auto", "columns", "bilinear"};
    static constexpr std::array<const char*, 3> kEarths = {"auto", "flat", "curved"};
    EngineOptions& engine = settings.engine;
    bool changed = shadingChoice(engine.render.shading.mode);
    changed |= choice("surface", engine.render.surface, kSurfaces);
    changed |= choice("earth", engine.earth.shape, kEarths);
    changed |= slider("exaggeration", engine.exaggeration, 0.5, 10, "%.2f", ImGuiSliderFlags_Logarithmic);
    double tolerance = engine.selection.tolerance.value();
    if (slider("tolerance", tolerance, 0.25, 16, "%.2f px", ImGuiSliderFlags_Logarithmic)) {
        engine.selection.tolerance = Pixels(tolerance);
        changed = true;
    }
    return changed;
}

struct HelpLine {
    const char* keys;
    const char* meaning;
};
constexpr HelpLine kHelp[] = {
    {"W A S D, arrows", "fly"},
    {"E, Q", "up, down"},
    {"Shift", "faster"},
    {"drag", "look around; in orbit and map: pull the ground"},
    {"right drag", "turn around the ground under the cursor"},
    {"wheel", "speed; in orbit and map: nearer, farther"},
    {"double click", "fly there"},
    {"F2 F3 F4 F5", "free flight, orbit, map, walk"},
    {"Home, N", "all of the dataset, north up"},
    {"1-9, Ctrl+1-9", "recall, store a bookmark"},
    {"G", "go to latitude, longitude or x, y"},
    {"Ctrl+C", "copy the camera (for --camera)"},
    {"P", "picture, with what draws it again beside it; its size: in the panel"},
    {"R, L", "record the flight, again: save it; replay it"},
    {"K", "keyframe editor of the flight"},
    {"Ins Enter Del", "in it: insert a key here, move it here, delete it"},
    {", .", "in it: the key before, the next one"},
    {"Ctrl+Z Y S", "in it: undo, redo, save"},
    {"T", "measuring tape: click two places"},
    {"F", "freeze what is drawn, show tiles"},
    {"H, O", "hide the panel, the instruments"},
    {"F11, V", "full screen, wait for the screen"},
    {"Esc, Ctrl+Q", "close what is open, quit"},
};

}  // namespace

bool drawPanel(ViewSettings& settings, Radians& fieldOfView) {
    ImGui::SetNextWindowPos(ImVec2(10, 10), ImGuiCond_FirstUseEver);
    bool changed = false;
    if (ImGui::Begin("View (H hides)", nullptr, ImGuiWindowFlags_AlwaysAutoResize)) {
        ImGui::PushItemWidth(14 * ImGui::GetFontSize());
        changed |= groundControls(settings);
        double degrees = degreesFromRadians(fieldOfView);
        if (slider("field of view", degrees, 5, 120, "%.0f deg")) fieldOfView = radiansFromDegrees(degrees);
        ImGui::Separator();
        changed |= lightControls(settings);
        ImGui::Separator();
        (void)choice("pictures (P)", settings.pictureSize, kPictureSizes);
        changed |=
            slider("frame rate held", settings.targetFps, 0, 144, settings.targetFps > 0 ? "%.0f a second" : "none");
        changed |= ImGui::Checkbox("count rays' steps", &settings.countSteps);
        ImGui::SameLine();
        changed |= ImGui::Checkbox("vsync", &settings.vsync);
        ImGui::TextDisabled("F1: keys");
        ImGui::PopItemWidth();
    }
    ImGui::End();
    return changed;
}

void drawHelp(bool& open) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(display.x / 2, display.y / 2), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    if (ImGui::Begin("Keys and mouse", &open, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse) &&
        ImGui::BeginTable("keys", 2)) {
        for (const HelpLine& line : kHelp) {
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(line.keys);
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(line.meaning);
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

std::optional<std::string> drawGoTo(bool& open, const std::string& failure) {
    static std::array<char, 128> text{};
    std::optional<std::string> answer;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(display.x / 2, display.y / 3), ImGuiCond_Appearing, ImVec2(0.5f, 0.5f));
    if (ImGui::Begin("Go to", &open, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse)) {
        if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
        if (ImGui::InputText("latitude, longitude or x, y", text.data(), text.size(),
                             ImGuiInputTextFlags_EnterReturnsTrue))
            answer = text.data();
        if (!failure.empty()) ImGui::TextWrapped("%s", failure.c_str());
    }
    ImGui::End();
    return answer;
}

}  // namespace terray
