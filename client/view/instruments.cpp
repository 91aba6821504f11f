#include "client/view/instruments.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <imgui.h>

#include "client/navigation/grab.h"
#include "client/view/readout.h"

namespace terray {
namespace {

constexpr ImU32 kInk = IM_COL32(255, 255, 255, 230);
constexpr ImU32 kShade = IM_COL32(0, 0, 0, 140);
constexpr ImGuiWindowFlags kLabel = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                                    ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoFocusOnAppearing |
                                    ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoSavedSettings;

ImVec2 at(glm::dvec2 pixel) {
    // ImGui's coordinates are the display's units.
    const ImVec2 density = ImGui::GetIO().DisplayFramebufferScale;
    return {static_cast<float>(pixel.x) / density.x, static_cast<float>(pixel.y) / density.y};
}

void memoryLine(const char* what, size_t tiles, uint64_t used, uint64_t budget) {
    ImGui::Text("%-8s %5zu tiles %9s of %s", what, tiles, bytesText(static_cast<double>(used)).c_str(),
                bytesText(static_cast<double>(budget)).c_str());
}

ImU32 levelColour(uint32_t level) {
    float r = 1, g = 1, b = 1;
    ImGui::ColorConvertHSVtoRGB(static_cast<float>(level % 12) / 12, 0.7f, 1, r, g, b);
    return ImGui::GetColorU32(ImVec4(r, g, b, 0.8f));
}

/// An edge of a box, cut where it comes too near the eye.
void drawEdge(const View& view, glm::dvec3 from, glm::dvec3 to, ImU32 colour) {
    constexpr int kPieces = 4;  // over a curved earth a straight edge is seen bent
    auto last = pixelOf(view, from);
    for (int piece = 1; piece <= kPieces; ++piece) {
        const auto next = pixelOf(view, glm::mix(from, to, static_cast<double>(piece) / kPieces));
        constexpr double kFar = 1e5;  // pixels: beyond, lines run through the eye
        const auto drawable = [](const auto& pixel) {
            return pixel && std::abs(pixel->x) < kFar && std::abs(pixel->y) < kFar;
        };
        if (drawable(last) && drawable(next)) ImGui::GetBackgroundDrawList()->AddLine(at(*last), at(*next), colour);
        last = next;
    }
}

}  // namespace

void drawInstruments(const InstrumentReadings& readings) {
    const FrameReport& report = readings.report;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(display.x - 10, display.y - 10), ImGuiCond_Always, ImVec2(1, 1));
    ImGui::SetNextWindowBgAlpha(0.55f);
    if (ImGui::Begin("instruments", nullptr, kLabel)) {
        const FrameHistory& history = readings.history;
        const std::vector<float> frames = history.milliseconds();
        const auto most = static_cast<float>(std::max(20.0, 1.2 * history.percentileMs(99)));
        ImGui::PlotLines("##ms", frames.data(), static_cast<int>(frames.size()), 0, nullptr, 0, most,
                         ImVec2(24 * ImGui::GetFontSize(), 4 * ImGui::GetFontSize()));
        ImGui::Text("frame %.1f ms   median %.1f   95%% %.1f   99%% %.1f", report.frameMs, history.percentileMs(50),
                    history.percentileMs(95), history.percentileMs(99));
        ImGui::Text("%d x %d pixels, tolerance %.2f px", readings.picture.x, readings.picture.y,
                    readings.options.selection.tolerance.value());
        if (readings.steps) {
            const double rays = static_cast<double>(readings.picture.x) * readings.picture.y;
            ImGui::Text("%.2f Mrays, steps %.1f, at most %u", rays / 1e6, readings.steps->mean, readings.steps->most);
        }
        memoryLine("heights", report.residentHeights, report.gpuTiles.heights + report.gpuTiles.maxima,
                   readings.options.gpuHeightBytes);
        if (report.gpuTiles.imagery > 0)
            memoryLine("photo", report.residentImagery, report.gpuTiles.imagery, readings.options.gpuImageryBytes);
        ImGui::Text("main memory %s of %s", bytesText(static_cast<double>(report.pager.hostBytes)).c_str(),
                    bytesText(static_cast<double>(readings.options.pager.hostBudgetBytes)).c_str());
        ImGui::Text("%zu nodes, %zu missing, %llu failed, %s/s", report.nodes, report.wanted,
                    static_cast<unsigned long long>(report.pager.failed),
                    bytesText(history.bytesPerSecond(readings.seconds)).c_str());
        ImGui::TextUnformatted(readings.camera.c_str());
    }
    ImGui::End();
}

void drawReadout(glm::dvec2 cursor, const std::string& text) {
    const ImVec2 place = at(cursor), size = ImGui::CalcTextSize(text.c_str()), display = ImGui::GetIO().DisplaySize;
    const ImVec2 corner(std::min(place.x + 18, display.x - size.x - 6), std::min(place.y + 18, display.y - size.y - 6));
    ImDrawList* const list = ImGui::GetBackgroundDrawList();
    list->AddRectFilled(ImVec2(corner.x - 4, corner.y - 4), ImVec2(corner.x + size.x + 4, corner.y + size.y + 4),
                        kShade, 3);
    list->AddText(corner, kInk, text.c_str());
}

void drawNorthArrow(Radians north) {
    const float radius = 1.6f * ImGui::GetFontSize();
    const ImVec2 centre(ImGui::GetIO().DisplaySize.x - radius - 14, radius + 14);
    const auto point = [&](double angle, float length) {
        const auto turned = north.value() + angle;
        return ImVec2(centre.x + length * static_cast<float>(std::sin(turned)),
                      centre.y - length * static_cast<float>(std::cos(turned)));
    };
    ImDrawList* const list = ImGui::GetBackgroundDrawList();
    list->AddCircleFilled(centre, radius, kShade);
    list->AddTriangleFilled(point(0, 0.9f * radius), point(2.6, 0.7f * radius), point(3.14159, 0.3f * radius),
                            IM_COL32(230, 70, 60, 255));
    list->AddTriangleFilled(point(0, 0.9f * radius), point(3.14159, 0.3f * radius), point(-2.6, 0.7f * radius), kInk);
}

void drawScaleBar(Pixels pixels, Metres length) {
    const std::string text = lengthText(length);
    const ImVec2 end = at({pixels.value(), 0});
    const ImVec2 left(14, ImGui::GetIO().DisplaySize.y - 18);
    ImDrawList* const list = ImGui::GetBackgroundDrawList();
    list->AddRectFilled(ImVec2(left.x - 6, left.y - 24), ImVec2(left.x + end.x + 6, left.y + 8), kShade, 3);
    list->AddLine(left, ImVec2(left.x + end.x, left.y), kInk, 2);
    for (const float x : {left.x, left.x + end.x}) list->AddLine(ImVec2(x, left.y - 5), ImVec2(x, left.y + 1), kInk, 2);
    list->AddText(ImVec2(left.x + 2, left.y - 21), kInk, text.c_str());
}

void drawTileBoxes(const View& view, const Tiling& tiling, std::span<const DrawNode> nodes) {
    for (const DrawNode& node : nodes) {
        const GroundRect ground = tiling.bounds(node.cell);
        const auto corner = [&](int n) {
            return glm::dvec3(n & 1 ? ground.east : ground.west, n & 2 ? ground.north : ground.south,
                              view.exaggeration * (n & 4 ? node.maxHeight : node.minHeight));
        };
        for (int n = 0; n < 8; ++n)
            for (const int bit : {1, 2, 4})
                if ((n & bit) == 0) drawEdge(view, corner(n), corner(n | bit), levelColour(node.cell.level));
    }
}

void drawNotice(const std::string& text) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(display.x / 2, 12), ImGuiCond_Always, ImVec2(0.5f, 0));
    ImGui::SetNextWindowBgAlpha(0.7f);
    if (ImGui::Begin("notice", nullptr, kLabel)) ImGui::TextUnformatted(text.c_str());
    ImGui::End();
}

}  // namespace terray
