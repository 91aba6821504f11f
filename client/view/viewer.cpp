#include "client/view/viewer.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

#include "client/engine/dataset_camera.h"
#include "client/engine/program.h"
#include "client/render/gl_context.h"
#include "client/view/viewer_state.h"

namespace terray {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kIdleWait = 0.25;     // seconds until a signal is noticed
constexpr double kArrivalWait = 0.01;  // between frames that only wait for tiles
constexpr int kBarrenFrames = 5;       // in a row, and seconds, without a tile: no more will come
constexpr double kBarrenSeconds = 0.5;
constexpr double kRetrySeconds = 2;  // until tiles that a server could not give are wanted again
constexpr int kPanelFrames = 3;      // until a panel has answered to what the mouse did

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A source over which the current context can draw.
const TileSource& drawable(const TileSource& source) {
    requireRendererFeatures();
    return source;
}

/// The engine starts with photos even where the first shading shows none, so that another may.
EngineOptions withPhotos(EngineOptions options) {
    options.render.shading.mode = Shading::photo;
    return options;
}

/// Nothing is queued, read or decoded.
bool idle(const PagerStatistics& pager) {
    return pager.requested + pager.hostHits == pager.delivered + pager.failed + pager.cancelled;
}

}  // namespace

Viewer::State::State(const TileSource& tiles, const ShaderLibrary& shaders, const ViewerOptions& given)
    : source(tiles),
      options(given),
      projection(projectionOf(source.metadata())),
      window(options.window),
      gui(window),
      engine(drawable(source), shaders, withPhotos(options.engine), window.size().x, window.size().y),
      ground(source, {.edits = options.engine.edits}),
      navigator(scene(), options.camera ? *options.camera : home()),
      controls(navigator, [this](glm::dvec2 pixel) { return pick(pixel); }),
      settings(settingsFrom(options.engine, source.metadata())),
      bookmarksFile(options.bookmarks) {
    settings.vsync = options.window.vsync;
    settings.targetFps = options.targetFps;
    restorePanels(options.remembered, settings);
    if (bookmarksFile) bookmarks = loadBookmarks(*bookmarksFile);
    applySettings();
}

Viewer::State::~State() = default;

NavigationScene Viewer::State::scene() {
    const DatasetMetadata& metadata = source.metadata();
    return {.ground = &ground,
            .extent = metadata.groundBounds(),
            .lowest = metadata.minHeight,
            .highest = metadata.maxHeight,
            .view = [this](const Camera& camera) {
                View view = engine.viewFrom(camera);
                view.width = window.size().x;
                view.height = window.size().y;
                return view;
            }};
}

std::optional<glm::dvec3> Viewer::State::placeUnder(glm::dvec2 pixel) const {
    const glm::dvec2 shown(engine.targets().width(), engine.targets().height());
    const glm::dvec2 texel = glm::floor(glm::clamp(pixel * shown / glm::dvec2(window.size()), -1.0, 1e6));
    return engine.placeAt(static_cast<int>(texel.x), static_cast<int>(texel.y));
}

std::optional<glm::dvec3> Viewer::State::pick(glm::dvec2 pixel) const {
    auto place = placeUnder(pixel);
    if (place) place->z *= engine.options().exaggeration;
    return place;
}

bool Viewer::State::moving() const {
    return navigator.moving() || controls.motion() != Motion{} || replayed || quality.sharpening() ||
           (editor && editor->playing());
}

void Viewer::State::take(const WindowEvent& event) {
    using Kind = WindowEvent::Kind;
    uncomposed = kPanelFrames;
    stale |= event.kind == Kind::exposed;
    const bool mouse = event.kind == Kind::buttonDown || event.kind == Kind::wheel;
    if ((mouse && gui.hasMouse()) || (event.kind == Kind::keyDown && event.key != Key::escape && gui.hasKeyboard()))
        return;
    if (measuring && event.kind == Kind::buttonDown && event.button == MouseButton::left) {
        if (tape.size() == 2) tape.clear();
        if (const auto place = placeUnder(controls.cursor())) tape.emplace_back(place->x, place->y);
        return;
    }
    const bool captured = controls.capturesCursor();
    if (const auto command = controls.handle(event, clock)) obey(*command);
    if (controls.capturesCursor() != captured) window.captureCursor(!captured);
}

void Viewer::State::takeDuringPicture(const WindowEvent& event) {
    if (event.kind != WindowEvent::Kind::keyDown) return;
    if (event.key == letter('Q') && event.control) window.close();
    if (event.key != Key::escape) return;
    endPicture();
    say("the picture was given up");
}

void Viewer::State::moveCamera(double flown) {
    if (const auto gamepad = window.gamepad()) controls.handle(*gamepad, flown);
    const Motion motion = controls.motion();
    const bool steered = motion != Motion{} || controls.capturesCursor();
    if (editor && steered) editor->pause();
    if (editor && editor->playing()) {
        editor->advance(flown);
        lookAtMoment();
        uncomposed = std::max(uncomposed, 1);
    } else if (replayed && !steered) {
        replayed = *replayed + flown;
        navigator.place(lastFlight.at(*replayed));
        if (*replayed >= lastFlight.seconds()) replayed.reset();
    } else {
        replayed.reset();
        if (motion != Motion{} || navigator.moving()) navigator.step(motion, flown);
    }
    if (recorder) recorder->record(clock, navigator.camera());
}

bool Viewer::State::advance(const std::vector<WindowEvent>& events, double seconds, double flown) {
    clock += seconds;
    controls.setWindowHeight(window.size().y);
    for (const WindowEvent& event : events) {
        if (picture) {
            takeDuringPicture(event);
        } else {
            take(event);
        }
    }
    if (picture) continuePicture();
    if (picture) {
        compose();
        return true;
    }
    moveCamera(flown);
    if (!notice.empty() && clock >= noticeUntil) {
        notice.clear();
        uncomposed = 1;
    }
    if (window.iconified()) return false;
    stale |= (retryAt && clock >= *retryAt) || quality.sharpening();
    const bool redraw = stale || wantedMarks() != marked || paging || navigator.camera() != drawn;
    if (redraw) draw(seconds);
    if (!redraw && uncomposed == 0) return false;
    uncomposed = std::max(uncomposed - 1, 0);
    compose();
    return true;
}

void Viewer::State::draw(double seconds) {
    quality.tell(report.frameMs, seconds, navigator.camera() != drawn);
    applyQuality();
    if (navigator.camera() != drawn) barrenFrames = 0;
    drawn = navigator.camera();
    drawMarks();
    try {
        // While a flight is recorded its pictures are those of its poses as the file will tell them.
        report = engine.drawFrame(recorder ? asWritten(drawn) : drawn, false);
    } catch (const Error& error) {
        // The only thing that a camera's place can spoil: there, no hour of the day is known.
        if (error.code() != ExitCode::georeference || !settings.sun.byTime) throw;
        settings.sun.byTime = false;
        say(error.what());
        applySettings();
        return;
    }
    stale = false;
    noteProgress();
}

void Viewer::State::noteProgress() {
    const bool came = report.uploadedTiles > 0 || !idle(report.pager);
    barrenFrames = came ? 0 : barrenFrames + 1;
    if (came) progress = Clock::now();
    // The pager's thread counts what it was asked for a moment later, so a frame alone says nothing.
    const bool barren = barrenFrames >= kBarrenFrames && secondsSince(progress) > kBarrenSeconds;
    paging = !frozen && (report.wanted > 0 || came) && !barren;
    retryAt = report.unreachable.empty() ? std::nullopt : std::optional(clock + kRetrySeconds);
    if (!report.failures.empty()) say(report.failures.front());
    history.add(report.frameMs, clock, report.pager.bytesRead);
    steps.reset();
    if (settings.countSteps) {
        uint64_t sum = 0;
        steps.emplace();
        const Grid<uint32_t> counts = engine.targets().readSteps();
        for (const uint32_t cell : counts.cells()) {
            sum += cell & kStepCountMask;
            steps->most = std::max(steps->most, cell & kStepCountMask);
        }
        steps->mean = static_cast<double>(sum) / static_cast<double>(counts.cells().size());
    }
    const double ms = 1e3 * secondsSince(options.started);
    if (!firstPictureMs) firstPictureMs = ms;
    if (!fullDetailMs && report.wanted == 0) fullDetailMs = ms;
}

void Viewer::State::compose() {
    gui.begin();
    if (picture) {
        drawNotice("picture: " + std::to_string(picture->drawn()) + " of " + std::to_string(picture->parts()) +
                   " parts are drawn (Esc gives it up)");
    } else {
        declareGui();
    }
    gui.end();
    present();
}

void Viewer::State::present() {
    const glm::ivec2 size = window.size();
    if (picture) {
        screen.showKept(size.x, size.y);
    } else {
        screen.show(engine.targets(), size.x, size.y);
    }
    gui.draw();
}

Viewer::Viewer(const TileSource& source, const ShaderLibrary& shaders, const ViewerOptions& options)
    : state_(std::make_unique<State>(source, shaders, options)) {}

Viewer::~Viewer() = default;

void Viewer::run() {
    while (!state_->window.closing()) {
        throwIfInterrupted();
        turn(kIdleWait);
    }
}

bool Viewer::turn(double waitSeconds) {
    State& state = *state_;
    const bool moving = state.moving();
    const bool busy = moving || state.stale || state.uncomposed > 0 || state.picture;
    const double untilNotice = state.notice.empty() ? waitSeconds : std::max(state.noticeUntil - state.clock, 0.01);
    const double wait = busy ? 0 : state.paging ? kArrivalWait : std::min(waitSeconds, untilNotice);
    const bool polled = state.window.gamepad().has_value();  // GLFW tells nothing of sticks
    const std::vector<WindowEvent> events = state.window.takeEvents(polled ? std::min(wait, kArrivalWait) : wait);
    const double seconds = secondsSince(state.lastTurn);
    state.lastTurn = Clock::now();
    // Time that was spent waiting is none that the camera flew.
    const bool drew = state.advance(events, seconds, moving ? seconds : 0);
    if (drew) state.window.swap();
    return drew;
}

bool Viewer::turnFor(double seconds) {
    const bool drew = state_->advance(state_->window.takeEvents(0), seconds, seconds);
    if (drew) state_->window.swap();
    return drew;
}

Window& Viewer::window() {
    return state_->window;
}

const Navigator& Viewer::navigator() const {
    return state_->navigator;
}

const Engine& Viewer::engine() const {
    return state_->engine;
}

const FrameReport& Viewer::report() const {
    return state_->report;
}

const ViewSettings& Viewer::settings() const {
    return state_->settings;
}

const std::string& Viewer::notice() const {
    return state_->notice;
}

bool Viewer::frozen() const {
    return state_->frozen;
}

const FlightEditor* Viewer::editor() const {
    return state_->editor ? &*state_->editor : nullptr;
}

Grid<Rgba> Viewer::screenshot() {
    // After a swap the back buffer holds nothing in particular.
    state_->present();
    const glm::ivec2 size = state_->window.size();
    return readScreen(size.x, size.y);
}

std::optional<double> Viewer::firstPictureMs() const {
    return state_->firstPictureMs;
}

std::optional<double> Viewer::fullDetailMs() const {
    return state_->fullDetailMs;
}

}  // namespace terray
