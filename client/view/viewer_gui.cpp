#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <glm/geometric.hpp>
#include <imgui.h>

#include "client/navigation/grab.h"
#include "client/view/panel.h"
#include "client/view/readout.h"
#include "client/view/viewer_state.h"

namespace terray {
namespace {

constexpr double kLongestBar = 160;  // pixels of the scale bar, before the display's scale

const char* nameOf(NavigationMode mode) {
    static constexpr std::array<const char*, 4> kNames = {"free flight", "orbit", "map", "walk"};
    return kNames.at(static_cast<size_t>(mode));
}

}  // namespace

View Viewer::State::windowView() const {
    View view = engine.viewFrom(navigator.camera());
    view.width = window.size().x;
    view.height = window.size().y;
    return view;
}

void Viewer::State::declareGui() {
    declareMap();
    if (measuring) declareTape();
    if (settings.panel) {
        Radians fieldOfView = navigator.camera().verticalFov;
        if (drawPanel(settings, fieldOfView)) applySettings();
        if (fieldOfView != navigator.camera().verticalFov) navigator.setFieldOfView(fieldOfView);
    }
    if (settings.instruments)
        drawInstruments({.report = report,
                         .history = history,
                         .options = engine.options(),
                         .seconds = clock,
                         .steps = steps,
                         .picture = {engine.targets().width(), engine.targets().height()},
                         .camera = cameraLine()});
    if (editor) declareEditor();
    if (help) drawHelp(help);
    if (goTo)
        if (const auto text = drawGoTo(goTo, goToFailure)) goToPlace(*text);
    if (recorder && notice.empty()) {
        drawNotice("recording");
    } else if (!notice.empty()) {
        drawNotice(notice);
    }
}

void Viewer::State::declareMap() {
    const Camera& camera = navigator.camera();
    Radians north;
    if (projection)
        if (const auto turned = projection->gridHeadingOfNorth(glm::dvec2(camera.position))) north = *turned;
    drawNorthArrow(north - camera.heading);

    const View view = windowView();
    const glm::dvec2 middle = glm::dvec2(window.size()) / 2.0;
    if (const auto centre = pick(middle)) {
        const double metresPerPixel = glm::dot(seenOffset(view, *centre), view.forward) / view.focalPixels();
        if (metresPerPixel > 0) {
            const Metres length = scaleBarLength(Metres(kLongestBar * window.contentScale() * metresPerPixel));
            drawScaleBar(Pixels(length.value() / metresPerPixel), length);
        }
    }
    if (frozen) drawTileBoxes(view, source.metadata().tiling, engine.nodes());
    if (settings.instruments && !gui.hasMouse() && !controls.capturesCursor())
        if (const std::string text = readout(); !text.empty()) drawReadout(controls.cursor(), text);
}

std::string Viewer::State::readout() {
    const auto place = placeUnder(controls.cursor());
    if (!place) return {};
    std::string text = describePlace(*place, projectionOrNull());
    const Tiling& tiling = source.metadata().tiling;
    // Of the ground that is known there, over a finest sample to each side.
    if (const auto slope = slopeAt(ground, glm::dvec2(*place), Metres(tiling.finestSpacing))) {
        std::array<char, 32> line{};
        std::snprintf(line.data(), line.size(), "\nslope %.0f deg", degreesFromRadians(*slope));
        text += line.data();
    }
    return text + "\n" + lengthText(Metres(glm::distance(*place, navigator.camera().position))) + " away";
}

std::string Viewer::State::cameraLine() const {
    std::string text = nameOf(navigator.mode());
    if (const auto height = navigator.heightOverGround()) text += ", " + lengthText(Metres(*height)) + " over ground";
    std::array<char, 32> speed{};
    std::snprintf(speed.data(), speed.size(), ", speed x%.2g", navigator.speedFactor());
    return text + speed.data() + (frozen ? ", FROZEN" : "");
}

void Viewer::State::declareTape() {
    if (tape.size() < 2) {
        drawNotice(tape.empty() ? "tape: click the first place" : "tape: click the second place");
        return;
    }
    if (!tapeGround) {
        // So fine that a step of the profile is about a sample: a long tape needs few tiles.
        const Tiling& tiling = source.metadata().tiling;
        uint32_t level = 0;
        while (level < tiling.finestLevel && tiling.spacing(level) > glm::distance(tape[0], tape[1]) / 400) ++level;
        tapeGround = std::make_unique<GroundTiles>(
            source, GroundTiles::Options{.edits = options.engine.edits, .finestLevel = level});
    }
    const TapeReading reading = readTape(*tapeGround, tape[0], tape[1], projectionOrNull());
    if (tapeGround->learning()) uncomposed = std::max(uncomposed, 2);
    const View view = windowView();
    ImDrawList* const list = ImGui::GetBackgroundDrawList();
    const ImVec2 density = ImGui::GetIO().DisplayFramebufferScale;
    std::optional<ImVec2> last;
    std::vector<float> heights;
    for (const glm::dvec3& place : reading.profile) {
        heights.push_back(static_cast<float>(place.z));
        const auto pixel = pixelOf(view, {place.x, place.y, view.exaggeration * place.z});
        const bool seen = pixel && glm::length(*pixel) < 1e5;
        const ImVec2 now =
            seen ? ImVec2(static_cast<float>(pixel->x) / density.x, static_cast<float>(pixel->y) / density.y)
                 : ImVec2();
        if (seen && last) list->AddLine(*last, now, IM_COL32(255, 220, 40, 255), 2);
        last = seen ? std::optional(now) : std::nullopt;
    }
    if (ImGui::Begin("Tape (T closes)", nullptr, ImGuiWindowFlags_AlwaysAutoResize)) {
        ImGui::Text("straight %s%s", lengthText(reading.straight).c_str(), projection ? " (geodesic)" : "");
        ImGui::Text("along the ground %s, climbs %s", lengthText(reading.alongGround).c_str(),
                    lengthText(reading.climb).c_str());
        const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
        ImGui::Text("heights %.0f .. %.0f m", static_cast<double>(*low), static_cast<double>(*high));
        ImGui::PlotLines("##profile", heights.data(), static_cast<int>(heights.size()), 0, nullptr, *low, *high,
                         ImVec2(26 * ImGui::GetFontSize(), 7 * ImGui::GetFontSize()));
    }
    ImGui::End();
}

}  // namespace terray
