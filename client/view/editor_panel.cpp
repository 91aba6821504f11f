#include "client/view/editor_panel.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include <imgui.h>

#include "client/view/readout.h"

namespace terray {
namespace {

constexpr int kRowsShown = 6;
constexpr float kHeight = 29;         // of the window, in heights of its letters, about
constexpr double kThinDegrees = 0.5;  // of heading, pitch and field of view

void tell(EditorWishes& wishes, const Result<void>& done) {
    if (!done) wishes.failure = done.failure().message;
}

bool enabledButton(const char* label, bool enabled) {
    ImGui::BeginDisabled(!enabled);
    const bool pressed = ImGui::Button(label);
    ImGui::EndDisabled();
    return pressed;
}

/// A number that counts once Enter was pressed.
bool numberField(const char* label, double& value, const char* format) {
    ImGui::SetNextItemWidth(6 * ImGui::GetFontSize());
    return ImGui::InputDouble(label, &value, 0, 0, format, ImGuiInputTextFlags_EnterReturnsTrue);
}

void keyRow(FlightEditor& editor, size_t index, const Projection* projection, EditorWishes& wishes) {
    const FlightKey& key = editor.flight().keys[index];
    std::array<char, 48> text{};
    std::snprintf(text.data(), text.size(), "%zu", index + 1);
    ImGui::TableNextColumn();
    if (ImGui::Selectable(text.data(), editor.selected() == index, ImGuiSelectableFlags_SpanAllColumns)) {
        editor.select(index);
        wishes.look = true;
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", describePlace(key.camera.position, projection).c_str());
    ImGui::TableNextColumn();
    ImGui::Text("%.3f s", key.seconds);
    const glm::dvec3& place = key.camera.position;
    const auto lonLat = projection != nullptr ? projection->lonLat(glm::dvec2(place)) : Result<LonLat>(Failure{});
    ImGui::TableNextColumn();
    if (lonLat) {
        ImGui::Text("%.5f, %.5f", lonLat->latitude, lonLat->longitude);
    } else {
        ImGui::Text("%.0f, %.0f", place.x, place.y);
    }
    ImGui::TableNextColumn();
    ImGui::Text("%.0f m", place.z);
    ImGui::TableNextColumn();
    ImGui::Text("%.0f, %.0f", degreesFromRadians(key.camera.heading), degreesFromRadians(key.camera.pitch));
}

void keyTable(FlightEditor& editor, const Projection* projection, EditorWishes& wishes) {
    const ImVec2 size(48 * ImGui::GetFontSize(),
                      static_cast<float>(kRowsShown + 1) * ImGui::GetTextLineHeightWithSpacing());
    constexpr ImGuiTableFlags kFlags =
        ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg | ImGuiTableFlags_Borders | ImGuiTableFlags_SizingFixedFit;
    if (!ImGui::BeginTable("keys", 5, kFlags, size)) return;
    ImGui::TableSetupScrollFreeze(0, 1);
    for (const char* heading :
         {"key", "time", projection != nullptr ? "latitude, longitude" : "x, y", "height", "heading, pitch"})
        ImGui::TableSetupColumn(heading);
    ImGui::TableHeadersRow();
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(editor.flight().keys.size()));
    while (clipper.Step())
        for (int row = clipper.DisplayStart; row < clipper.DisplayEnd; ++row)
            keyRow(editor, static_cast<size_t>(row), projection, wishes);
    ImGui::EndTable();
}

void timeControls(FlightEditor& editor, EditorWishes& wishes) {
    if (enabledButton(editor.playing() ? "pause" : "play (L)", editor.flight().seconds() > 0))
        editor.playing() ? editor.pause() : editor.play();
    ImGui::SameLine();
    double seconds = editor.seconds();
    const double first = 0, last = std::max(editor.flight().seconds(), 1e-3);
    ImGui::SetNextItemWidth(40 * ImGui::GetFontSize());
    if (ImGui::SliderScalar("##time", ImGuiDataType_Double, &seconds, &first, &last, "%.3f s",
                            ImGuiSliderFlags_AlwaysClamp)) {
        editor.scrub(seconds);
        wishes.look = true;
    }
}

void keyControls(FlightEditor& editor, const Camera& camera, EditorWishes& wishes) {
    ImGui::TextUnformatted("the camera's place:");
    ImGui::SameLine();
    if (ImGui::Button("add at the end")) tell(wishes, editor.append(camera));
    ImGui::SameLine();
    if (ImGui::Button("insert behind the selected (Ins)")) tell(wishes, editor.insert(camera));
    ImGui::SameLine();
    if (enabledButton("add at this time", !editor.flight().keys.empty())) tell(wishes, editor.addHere(camera));
    ImGui::TextUnformatted("the selected key:");
    ImGui::SameLine();
    if (enabledButton("move to the camera (Enter)", editor.selected().has_value())) tell(wishes, editor.move(camera));
    ImGui::SameLine();
    if (enabledButton("delete (Del)", editor.selected().has_value())) tell(wishes, editor.remove());
}

void timing(FlightEditor& editor, EditorPanel& panel, EditorWishes& wishes) {
    ImGui::BeginDisabled(!editor.selected());
    double seconds = editor.selected() ? editor.flight().keys[*editor.selected()].seconds : 0;
    if (numberField("s: time of the key", seconds, "%.3f")) tell(wishes, editor.retime(seconds, panel.moveLater));
    ImGui::SameLine();
    ImGui::Checkbox("later keys come along", &panel.moveLater);
    ImGui::EndDisabled();
    double duration = editor.flight().seconds();
    if (numberField("s: all of the flight", duration, "%.3f")) tell(wishes, editor.setDuration(duration));
    if (enabledButton("thin", editor.flight().keys.size() > 2))
        tell(wishes, editor.thin(Metres(panel.thinMetres), radiansFromDegrees(kThinDegrees)));
    ImGui::SameLine();
    ImGui::SetNextItemWidth(6 * ImGui::GetFontSize());
    ImGui::InputDouble("m: as near the path stays without the keys left out", &panel.thinMetres, 0, 0, "%.2f");
}

void fileControls(FlightEditor& editor, EditorPanel& panel, EditorWishes& wishes) {
    if (enabledButton("undo (Ctrl+Z)", editor.canUndo())) editor.undo();
    ImGui::SameLine();
    if (enabledButton("redo (Ctrl+Y)", editor.canRedo())) editor.redo();
    ImGui::SameLine();
    wishes.save = enabledButton("save (Ctrl+S)", !editor.flight().keys.empty());
    ImGui::SameLine();
    wishes.load = ImGui::Button("load");
    std::array<char, 1024> text{};
    std::snprintf(text.data(), text.size(), "%s", panel.file.c_str());
    ImGui::SetNextItemWidth(45 * ImGui::GetFontSize());
    if (ImGui::InputText("file", text.data(), text.size())) panel.file = text.data();
}

}  // namespace

EditorWishes drawEditor(FlightEditor& editor, EditorPanel& panel, const Camera& camera, bool& open) {
    EditorWishes wishes;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const float top = std::max(10.0f, display.y - kHeight * ImGui::GetFontSize());
    ImGui::SetNextWindowPos(ImVec2(10, top), ImGuiCond_FirstUseEver);
    std::array<char, 80> title{};
    std::snprintf(title.data(), title.size(), "Keyframes (K closes): %zu keys, %.1f s%s###keyframes",
                  editor.flight().keys.size(), editor.flight().seconds(), editor.changed() ? ", not saved" : "");
    if (ImGui::Begin(title.data(), &open, ImGuiWindowFlags_AlwaysAutoResize)) {
        keyTable(editor, panel.projection, wishes);
        timeControls(editor, wishes);
        keyControls(editor, camera, wishes);
        ImGui::Separator();
        timing(editor, panel, wishes);
        ImGui::Separator();
        fileControls(editor, panel, wishes);
    }
    ImGui::End();
    return wishes;
}

}  // namespace terray
