#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cmath>
#include <ctime>

#include "client/engine/dataset_camera.h"
#include "client/navigation/place_text.h"
#include "client/view/viewer_state.h"
#include "common/error.h"

namespace terray {
namespace {

constexpr double kNoticeSeconds = 4;
/// How far a camera stands back from a place that it was sent to, at least: metres.
constexpr double kLeastDistance = 500;

/// "20260621-143000", UTC.
std::string stamp() {
    const std::time_t now = std::time(nullptr);
    std::array<char, 32> text{};
    std::strftime(text.data(), text.size(), "%Y%m%d-%H%M%S", std::gmtime(&now));
    return text.data();
}

/// Without what a file's name had better not hold.
std::string asFileName(std::string text) {
    for (char& letter : text)
        if (!std::isalnum(static_cast<unsigned char>(letter)) && letter != '-' && letter != '_') letter = '-';
    return text;
}

}  // namespace

void Viewer::State::say(std::string text) {
    notice = std::move(text);
    noticeUntil = clock + kNoticeSeconds;
    uncomposed = std::max(uncomposed, 1);
}

Camera Viewer::State::home() const {
    const double aspect = static_cast<double>(window.size().x) / window.size().y;
    return overviewCamera(source.metadata(), aspect, engine.earth(), engine.options().exaggeration);
}

void Viewer::State::obey(const CommandEvent& event) {
    // What goes wrong with a file is said; the flight goes on.
    try {
        switch (event.command) {
            case Command::quit:
                window.close();
                break;
            case Command::help:
                help = !help;
                break;
            case Command::panel:
                settings.panel = !settings.panel;
                break;
            case Command::overlay:
                settings.instruments = !settings.instruments;
                break;
            case Command::freeze:
                frozen = !frozen;
                engine.freezeSelection(frozen);
                stale = true;
                break;
            case Command::measure:
                measuring = !measuring;
                tape.clear();
                tapeGround.reset();
                break;
            case Command::fullScreen:
                window.setFullScreen(!window.fullScreen());
                break;
            case Command::vsync:
                settings.vsync = !settings.vsync;
                window.setVsync(settings.vsync);
                break;
            case Command::home:
                navigator.flyTo(home());
                break;
            case Command::north: {
                Camera north = navigator.camera();
                north.heading = Radians(0);
                navigator.flyTo(north);
                break;
            }
            case Command::goTo:
                goTo = !goTo;
                break;
            case Command::copyCamera:
                copyCamera();
                break;
            case Command::picture:
                takePicture();
                break;
            case Command::record:
                startOrSaveRecording();
                break;
            case Command::replay:
                startOrStopReplay();
                break;
            case Command::edit:
                openOrCloseEditor();
                break;
            case Command::insertKey:
            case Command::moveKey:
            case Command::deleteKey:
            case Command::previousKey:
            case Command::nextKey:
            case Command::undo:
            case Command::redo:
            case Command::save:
                edit(event.command);
                break;
            case Command::recall:
            case Command::store:
                recallOrStore(event);
                break;
            case Command::cancel:
                cancel();
                break;
        }
    } catch (const Error& error) {
        say(error.what());
    }
}

void Viewer::State::cancel() {
    if (measuring) tape.clear();
    help = goTo = measuring = false;
    replayed.reset();
    if (editor) editor->pause();
}

void Viewer::State::recallOrStore(const CommandEvent& event) {
    std::optional<Camera>& bookmark = bookmarks.cameras.at(static_cast<size_t>(event.number) - 1);
    const std::string name = "bookmark " + std::to_string(event.number);
    if (event.command == Command::recall) {
        if (bookmark) navigator.flyTo(*bookmark);
        if (!bookmark) say(name + " is empty: Ctrl+" + std::to_string(event.number) + " stores it");
        return;
    }
    bookmark = navigator.camera();
    if (bookmarksFile) saveBookmarks(bookmarks, *bookmarksFile, projectionOrNull());
    say(name + (bookmarksFile ? " stored" : " stored for this run only: the environment names no home"));
}

void Viewer::State::goToPlace(const std::string& text) {
    const auto place = parsePlace(text, projectionOrNull());
    if (!place) {
        goToFailure = place.failure().message;
        return;
    }
    goToFailure.clear();
    goTo = false;
    const auto below = ground.under(*place);
    if (!below) say("no ground there: the dataset lies elsewhere");
    Camera goal = navigator.camera();
    const double back = std::max(kLeastDistance, navigator.heightOverGround().value_or(kLeastDistance));
    if (navigator.mode() != NavigationMode::map) goal.pitch = radiansFromDegrees(-35);
    const glm::dvec3 target(*place, below ? below->height : source.metadata().minHeight);
    goal.position = target - back * viewOf(goal, 1, 1).forward;
    navigator.flyTo(goal);
}

void Viewer::State::copyCamera() {
    const auto text = formatCamera(navigator.camera(), projectionOrNull());
    if (text) window.setClipboard(*text);
    say(text ? "copied: --camera " + *text : text.failure().message);
}

std::filesystem::path Viewer::State::pictureName(const std::string& stem, const std::string& extension) const {
    const std::filesystem::path folder = options.pictures;
    const std::string name = asFileName(options.datasetName) + "-" + stem + stamp();
    std::filesystem::path path = folder / (name + extension);
    for (int n = 2; std::filesystem::exists(path); ++n) path = folder / (name + "-" + std::to_string(n) + extension);
    return path;
}

void Viewer::State::takePicture() {
    controls.letGo();
    window.captureCursor(false);
    screen.keep(engine.targets());
    engine.freezeSelection(false);
    // What the editor draws is none of the picture that its JSON draws again.
    if (marked) engine.setOverlay(options.engine.overlay);
    marked.reset();
    try {
        picture.emplace(engine, navigator.camera(),
                        SnapshotScene{.source = source,
                                      .projection = projectionOrNull(),
                                      .arguments = options.arguments,
                                      .settings = settings,
                                      .size = pictureSize(settings.pictureSize, window.size()),
                                      .part = options.part},
                        pictureName("", ".png"));
    } catch (...) {
        endPicture();
        throw;
    }
}

void Viewer::State::continuePicture() {
    try {
        picture->drawNext();
        if (!picture->finished()) return;
        say("picture: " + picture->path().string());
    } catch (const Error& error) {
        say(error.what());
    }
    endPicture();
}

void Viewer::State::endPicture() {
    picture.reset();
    screen.forget();
    engine.setOptions(settings.engine);
    frozen = false;  // what was selected last is a part of the picture
    stale = true;
}

void Viewer::State::startOrSaveRecording() {
    if (!recorder) {
        recorder.emplace();
        recorder->record(clock, navigator.camera());
        say("recording: R again saves the flight");
        return;
    }
    recorder->record(clock, navigator.camera());
    const std::filesystem::path path = pictureName("flight-", ".json");
    lastFlight = recorder->flight(options.datasetName, "recorded " + stamp());
    recorder.reset();
    saveFlight(lastFlight, path, projectionOrNull());
    lastFlightChanged = false;
    if (editor) {
        editor->replace(lastFlight);
        editor->saved();
        keepEditedFile(path);
    }
    say("flight of " + numberText(std::round(10 * lastFlight.seconds()) / 10) + " s: " + path.string());
}

void Viewer::State::startOrStopReplay() {
    if (editor) {
        editor->playing() ? editor->pause() : editor->play();
    } else if (replayed) {
        replayed.reset();
    } else if (lastFlight.keys.empty()) {
        say("nothing was recorded: R records a flight");
    } else {
        replayed = 0;
    }
}

void Viewer::State::applySettings() {
    settings.settle();
    window.setVsync(settings.vsync);
    quality.setTarget(settings.targetFps);
    ground.setColumns(settings.engine.render.surface == Surface::columns);
    engine.setOptions(settings.engine);
    stale = true;
}

void Viewer::State::applyQuality() {
    const glm::dvec2 size = glm::dvec2(window.size()) * quality.scale();
    engine.resize(std::max(1, static_cast<int>(std::lround(size.x))),
                  std::max(1, static_cast<int>(std::lround(size.y))));
    EngineOptions drawing = settings.engine;
    drawing.selection.tolerance = quality.toleranceFactor() * drawing.selection.tolerance;
    drawing.selection.imageryTolerance = quality.toleranceFactor() * drawing.selection.imageryTolerance;
    engine.setOptions(drawing);
}

}  // namespace terray
