#include "client/view/window.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "common/check.h"
#include "common/error.h"

namespace terray {
namespace {

std::string lastGlfwError() {
    const char* text = nullptr;
    return glfwGetError(&text) == GLFW_NO_ERROR || text == nullptr ? "GLFW gives no reason" : text;
}

Key keyOf(int glfwKey) {
    static constexpr std::pair<int, Key> kNamed[] = {
        {GLFW_KEY_ESCAPE, Key::escape},
        {GLFW_KEY_ENTER, Key::enter},
        {GLFW_KEY_TAB, Key::tab},
        {GLFW_KEY_HOME, Key::home},
        {GLFW_KEY_PAGE_UP, Key::pageUp},
        {GLFW_KEY_PAGE_DOWN, Key::pageDown},
        {GLFW_KEY_LEFT, Key::left},
        {GLFW_KEY_RIGHT, Key::right},
        {GLFW_KEY_UP, Key::up},
        {GLFW_KEY_DOWN, Key::down},
        {GLFW_KEY_INSERT, Key::insert},
        {GLFW_KEY_DELETE, Key::remove},
        {GLFW_KEY_LEFT_SHIFT, Key::shift},
        {GLFW_KEY_RIGHT_SHIFT, Key::shift},
        {GLFW_KEY_F1, Key::f1},
        {GLFW_KEY_F2, Key::f2},
        {GLFW_KEY_F3, Key::f3},
        {GLFW_KEY_F4, Key::f4},
        {GLFW_KEY_F5, Key::f5},
        {GLFW_KEY_F11, Key::f11},
    };
    const auto named =
        std::find_if(std::begin(kNamed), std::end(kNamed), [&](const auto& entry) { return entry.first == glfwKey; });
    if (named != std::end(kNamed)) return named->second;
    // GLFW's codes of these are their ASCII codes.
    const bool plain = glfwKey == GLFW_KEY_SPACE || glfwKey == GLFW_KEY_COMMA || glfwKey == GLFW_KEY_PERIOD ||
                       (glfwKey >= GLFW_KEY_0 && glfwKey <= GLFW_KEY_9) ||
                       (glfwKey >= GLFW_KEY_A && glfwKey <= GLFW_KEY_Z);
    return plain ? static_cast<Key>(glfwKey) : Key::none;
}

double stick(float value) {
    constexpr double kDead = 0.15;  // of a worn stick at rest
    const double size = std::abs(double{value});
    return size <= kDead ? 0 : std::copysign(std::min((size - kDead) / (1 - kDead), 1.0), value);
}

}  // namespace

struct Window::State {
    GLFWwindow* window = nullptr;
    std::vector<WindowEvent> events;
    bool vsync = true;
    glm::ivec2 place{0};  ///< of the window before it filled the screen
    glm::ivec2 extent{0};

    static State& of(GLFWwindow* window) { return *static_cast<State*>(glfwGetWindowUserPointer(window)); }
    /// Pixels of the framebuffer for a unit of the display's coordinates.
    [[nodiscard]] glm::dvec2 density() const {
        glm::ivec2 pixels, units;
        glfwGetFramebufferSize(window, &pixels.x, &pixels.y);
        glfwGetWindowSize(window, &units.x, &units.y);
        return glm::dvec2(pixels) / glm::dvec2(std::max(units.x, 1), std::max(units.y, 1));
    }
    void listen();
};

void Window::State::listen() {
    using Kind = WindowEvent::Kind;
    glfwSetWindowUserPointer(window, this);
    glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int mods) {
        if (action == GLFW_REPEAT || keyOf(key) == Key::none) return;
        of(w).events.push_back({.kind = action == GLFW_PRESS ? Kind::keyDown : Kind::keyUp,
                                .key = keyOf(key),
                                .control = (mods & GLFW_MOD_CONTROL) != 0});
    });
    glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int) {
        if (button > GLFW_MOUSE_BUTTON_MIDDLE) return;
        of(w).events.push_back({.kind = action == GLFW_PRESS ? Kind::buttonDown : Kind::buttonUp,
                                .button = static_cast<MouseButton>(button)});
    });
    glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
        of(w).events.push_back({.kind = Kind::cursor, .cursor = glm::dvec2(x, y) * of(w).density()});
    });
    glfwSetScrollCallback(
        window, [](GLFWwindow* w, double, double y) { of(w).events.push_back({.kind = Kind::wheel, .wheel = y}); });
    glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { of(w).events.push_back({.kind = Kind::exposed}); });
    glfwSetFramebufferSizeCallback(window,
                                   [](GLFWwindow* w, int, int) { of(w).events.push_back({.kind = Kind::exposed}); });
    glfwSetWindowFocusCallback(window, [](GLFWwindow* w, int focused) {
        if (focused == GLFW_FALSE) of(w).events.push_back({.kind = Kind::focusLost});
    });
}

Window::Window(const Options& options) : state_(std::make_unique<State>()) {
    if (glfwInit() != GLFW_TRUE)
        throw Error(ExitCode::display, "cannot open a window: " + lastGlfwError() +
                                           " (give --headless and --out FILE.png to draw without one)");
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, options.debug ? GLFW_TRUE : GLFW_FALSE);
    glfwWindowHint(GLFW_DEPTH_BITS, 0);  // the engine has targets of its own
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    state_->window = glfwCreateWindow(options.width, options.height, options.title.c_str(), nullptr, nullptr);
    if (state_->window == nullptr) {
        const std::string reason = lastGlfwError();
        glfwTerminate();
        throw Error(ExitCode::graphics,
                    "cannot make a window with OpenGL 4.5: " + reason +
                        " (update the display's driver, or draw with --headless and --out FILE.png)");
    }
    glfwMakeContextCurrent(state_->window);
    state_->listen();
    setVsync(options.vsync);
}

Window::~Window() {
    glfwDestroyWindow(state_->window);
    glfwTerminate();
}

glm::ivec2 Window::size() const {
    glm::ivec2 pixels;
    glfwGetFramebufferSize(state_->window, &pixels.x, &pixels.y);
    return {std::max(pixels.x, 1), std::max(pixels.y, 1)};
}

void Window::setSize(int width, int height) {
    glfwSetWindowSize(state_->window, width, height);
}

double Window::contentScale() const {
    float x = 1, y = 1;
    glfwGetWindowContentScale(state_->window, &x, &y);
    return std::max({1.0, double{x}, double{y}});
}

bool Window::iconified() const {
    return glfwGetWindowAttrib(state_->window, GLFW_ICONIFIED) == GLFW_TRUE;
}

bool Window::closing() const {
    return glfwWindowShouldClose(state_->window) == GLFW_TRUE;
}

void Window::close() {
    glfwSetWindowShouldClose(state_->window, GLFW_TRUE);
}

std::vector<WindowEvent> Window::takeEvents(double waitSeconds) {
    if (waitSeconds > 0 && state_->events.empty()) {
        glfwWaitEventsTimeout(waitSeconds);
    } else {
        glfwPollEvents();
    }
    return std::exchange(state_->events, {});
}

void Window::inject(const WindowEvent& event) {
    state_->events.push_back(event);
}

std::optional<Gamepad> Window::gamepad() const {
    for (int joystick = GLFW_JOYSTICK_1; joystick <= GLFW_JOYSTICK_LAST; ++joystick) {
        GLFWgamepadstate state;
        if (glfwJoystickIsGamepad(joystick) != GLFW_TRUE || glfwGetGamepadState(joystick, &state) != GLFW_TRUE)
            continue;
        const auto axis = [&](int number) { return stick(state.axes[number]); };
        const auto trigger = [&](int number) { return stick((state.axes[number] + 1) / 2); };
        const auto pressed = [&](int button) { return state.buttons[button] == GLFW_PRESS; };
        return Gamepad{.leftStick = {axis(GLFW_GAMEPAD_AXIS_LEFT_X), axis(GLFW_GAMEPAD_AXIS_LEFT_Y)},
                       .rightStick = {axis(GLFW_GAMEPAD_AXIS_RIGHT_X), axis(GLFW_GAMEPAD_AXIS_RIGHT_Y)},
                       .leftTrigger = trigger(GLFW_GAMEPAD_AXIS_LEFT_TRIGGER),
                       .rightTrigger = trigger(GLFW_GAMEPAD_AXIS_RIGHT_TRIGGER),
                       .a = pressed(GLFW_GAMEPAD_BUTTON_A),
                       .leftShoulder = pressed(GLFW_GAMEPAD_BUTTON_LEFT_BUMPER),
                       .rightShoulder = pressed(GLFW_GAMEPAD_BUTTON_RIGHT_BUMPER)};
    }
    return {};
}

void Window::swap() {
    glfwSwapBuffers(state_->window);
}

void Window::setVsync(bool on) {
    glfwSwapInterval(on ? 1 : 0);
    state_->vsync = on;
}

bool Window::vsync() const {
    return state_->vsync;
}

void Window::setFullScreen(bool on) {
    if (on == fullScreen()) return;
    GLFWwindow* const window = state_->window;
    if (!on) {
        glfwSetWindowMonitor(window, nullptr, state_->place.x, state_->place.y, state_->extent.x, state_->extent.y, 0);
        return;
    }
    GLFWmonitor* const monitor = glfwGetPrimaryMonitor();
    const GLFWvidmode* const mode = monitor == nullptr ? nullptr : glfwGetVideoMode(monitor);
    if (mode == nullptr) return;  // a display without a screen
    glfwGetWindowPos(window, &state_->place.x, &state_->place.y);
    glfwGetWindowSize(window, &state_->extent.x, &state_->extent.y);
    glfwSetWindowMonitor(window, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

bool Window::fullScreen() const {
    return glfwGetWindowMonitor(state_->window) != nullptr;
}

void Window::captureCursor(bool on) {
    glfwSetInputMode(state_->window, GLFW_CURSOR, on ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
}

void Window::setClipboard(const std::string& text) {
    glfwSetClipboardString(state_->window, text.c_str());
}

GLFWwindow* Window::handle() const {
    return state_->window;
}

}  // namespace terray
