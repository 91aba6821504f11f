#include "client/view/controls.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace terray {
namespace {

constexpr double kOrbitPerPixel = 0.005;      // radians
constexpr double kDoubleClickSeconds = 0.35;  // between the presses
constexpr double kDoubleClickPixels = 6;
constexpr double kSpeedPerNotch = 1.25;
constexpr double kZoomPerNotch = 0.8;
constexpr double kStickTurn = 1.5;  // radians per second at full deflection

struct Shortcut {
    Key key;
    bool control;
    Command command;
};
constexpr Shortcut kShortcuts[] = {
    {Key::f1, false, Command::help},           {letter('H'), false, Command::panel},
    {letter('O'), false, Command::overlay},    {letter('F'), false, Command::freeze},
    {letter('T'), false, Command::measure},    {Key::f11, false, Command::fullScreen},
    {letter('V'), false, Command::vsync},      {Key::home, false, Command::home},
    {letter('N'), false, Command::north},      {letter('G'), false, Command::goTo},
    {letter('C'), true, Command::copyCamera},  {letter('P'), false, Command::picture},
    {letter('R'), false, Command::record},     {letter('L'), false, Command::replay},
    {letter('K'), false, Command::edit},       {Key::insert, false, Command::insertKey},
    {Key::enter, false, Command::moveKey},     {Key::remove, false, Command::deleteKey},
    {Key::comma, false, Command::previousKey}, {Key::period, false, Command::nextKey},
    {letter('Z'), true, Command::undo},        {letter('Y'), true, Command::redo},
    {letter('S'), true, Command::save},        {Key::escape, false, Command::cancel},
    {letter('Q'), true, Command::quit},
};

std::optional<NavigationMode> modeOf(Key key) {
    switch (key) {
        case Key::f2:
            return NavigationMode::free;
        case Key::f3:
            return NavigationMode::orbit;
        case Key::f4:
            return NavigationMode::map;
        case Key::f5:
            return NavigationMode::walk;
        default:
            return {};
    }
}

}  // namespace

bool Controls::grabs() const {
    return navigator_.mode() == NavigationMode::orbit || navigator_.mode() == NavigationMode::map;
}

std::optional<CommandEvent> Controls::handle(const WindowEvent& event, double seconds) {
    switch (event.kind) {
        case WindowEvent::Kind::keyDown:
            return keyDown(event);
        case WindowEvent::Kind::keyUp:
            held_[static_cast<size_t>(event.key)] = false;
            break;
        case WindowEvent::Kind::buttonDown:
            buttonDown(event.button, seconds);
            break;
        case WindowEvent::Kind::buttonUp:
            if (event.button != dragButton_) break;
            drag_ = Drag::none;
            navigator_.release();
            break;
        case WindowEvent::Kind::cursor:
            moveTo(event.cursor);
            break;
        case WindowEvent::Kind::wheel:
            wheel(event.wheel);
            break;
        case WindowEvent::Kind::focusLost:
            letGo();
            break;
        case WindowEvent::Kind::exposed:
            break;
    }
    return {};
}

std::optional<CommandEvent> Controls::keyDown(const WindowEvent& event) {
    if (!event.control) held_[static_cast<size_t>(event.key)] = true;
    for (const Shortcut& shortcut : kShortcuts)
        if (shortcut.key == event.key && shortcut.control == event.control) return CommandEvent{shortcut.command};
    if (event.key >= letter('1') && event.key <= letter('9')) {
        const int number = static_cast<int>(event.key) - '0';
        return CommandEvent{event.control ? Command::store : Command::recall, number};
    }
    if (const auto mode = modeOf(event.key); mode && !event.control) navigator_.setMode(*mode);
    return {};
}

void Controls::buttonDown(MouseButton button, double seconds) {
    const bool second = button == MouseButton::left && seconds - lastClick_ < kDoubleClickSeconds &&
                        glm::distance(cursor_, lastClickAt_) < kDoubleClickPixels;
    lastClick_ = button == MouseButton::left && !second ? seconds : -1e9;
    lastClickAt_ = cursor_;
    if (!second) {
        beginDrag(button);
    } else if (const auto point = pick_(cursor_)) {
        navigator_.flyToLookAt(*point);
    }
}

void Controls::beginDrag(MouseButton button) {
    if (drag_ != Drag::none) return;
    dragButton_ = button;
    const bool walking = navigator_.mode() == NavigationMode::walk;
    const bool pans = button == MouseButton::left && grabs();
    const bool orbits = button != MouseButton::left && !walking;
    const auto point = pans || orbits ? pick_(cursor_) : std::nullopt;
    if (point) navigator_.grab(*point);
    // Where there is no ground to hold, the camera looks around.
    drag_ = !point ? Drag::look : pans ? Drag::pan : Drag::orbit;
}

void Controls::moveTo(glm::dvec2 cursor) {
    const glm::dvec2 by = cursor - moved_;
    moved_ = cursor;
    if (drag_ != Drag::orbit) cursor_ = cursor;
    const double perPixel = navigator_.camera().verticalFov.value() / windowHeight_;
    switch (drag_) {
        case Drag::none:
            break;
        case Drag::look:
            navigator_.turn(Radians(by.x * perPixel), Radians(-by.y * perPixel));
            break;
        case Drag::pan:
            navigator_.dragTo(cursor);
            break;
        case Drag::orbit:
            navigator_.orbit(Radians(by.x * kOrbitPerPixel), Radians(-by.y * kOrbitPerPixel));
            break;
    }
}

void Controls::wheel(double notches) {
    notches = std::clamp(notches, -10.0, 10.0);
    if (!grabs()) {
        navigator_.scaleSpeed(std::pow(kSpeedPerNotch, notches));
    } else if (const auto point = pick_(cursor_)) {
        navigator_.zoom(*point, std::pow(kZoomPerNotch, notches));
    }
}

void Controls::handle(const Gamepad& gamepad, double seconds) {
    gamepad_ = gamepad;
    if (gamepad.rightStick != glm::dvec2(0))
        navigator_.turn(Radians(gamepad.rightStick.x * kStickTurn * seconds),
                        Radians(-gamepad.rightStick.y * kStickTurn * seconds));
    const int faster = (gamepad.rightShoulder ? 1 : 0) - (gamepad.leftShoulder ? 1 : 0);
    if (faster != 0) navigator_.scaleSpeed(std::exp2(faster * seconds));
}

Motion Controls::motion() const {
    const auto axis = [&](Key plus, Key alsoPlus, Key minus, Key alsoMinus) {
        return (held(plus) || held(alsoPlus) ? 1.0 : 0.0) - (held(minus) || held(alsoMinus) ? 1.0 : 0.0);
    };
    const auto sum = [](double keys, double pad) { return std::clamp(keys + pad, -1.0, 1.0); };
    return {.right = sum(axis(letter('D'), Key::right, letter('A'), Key::left), gamepad_.leftStick.x),
            .ahead = sum(axis(letter('W'), Key::up, letter('S'), Key::down), -gamepad_.leftStick.y),
            .up = sum(axis(letter('E'), Key::pageUp, letter('Q'), Key::pageDown),
                      gamepad_.rightTrigger - gamepad_.leftTrigger),
            .fast = held(Key::shift) || gamepad_.a};
}

void Controls::letGo() {
    held_.fill(false);
    gamepad_ = {};
    drag_ = Drag::none;
    navigator_.release();
}

}  // namespace terray
