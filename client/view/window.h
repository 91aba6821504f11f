#pragma once

#include <memory>
#include <string>
#include <vector>

#include "client/view/window_event.h"

struct GLFWwindow;

namespace terray {

/// A window with an OpenGL 4.5 core context, by GLFW. Its context is current on the thread that made it, from
/// construction to destruction. One at a time; main thread only.
class Window {
  public:
    struct Options {
        std::string title = "Terray";
        int width = 1280;  ///< in the display's own units: on a display of high density more pixels
        int height = 720;
        bool vsync = true;
        bool debug = false;  ///< a debug context
    };
    /// Throws Error(display) when there is no display, Error(graphics) when it has no OpenGL 4.5.
    explicit Window(const Options& options);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    /// Of the framebuffer, pixels, at least 1 x 1.
    [[nodiscard]] glm::ivec2 size() const;
    /// Asks the display for another size, in its own units; it comes some events later.
    void setSize(int width, int height);
    /// How much larger than on a plain display text should be.
    [[nodiscard]] double contentScale() const;
    [[nodiscard]] bool iconified() const;
    /// Whether the person wants the window closed.
    [[nodiscard]] bool closing() const;
    void close();

    /// What has happened since the last call, in order; waits for the first of it at most so long. 0: not at all.
    [[nodiscard]] std::vector<WindowEvent> takeEvents(double waitSeconds);
    /// As if it had happened: for tests.
    void inject(const WindowEvent& event);
    /// The first gamepad that GLFW knows the layout of; none without one.
    [[nodiscard]] std::optional<Gamepad> gamepad() const;

    void swap();
    void setVsync(bool on);
    [[nodiscard]] bool vsync() const;
    /// The whole of the screen that the window is on, and back to where it was.
    void setFullScreen(bool on);
    [[nodiscard]] bool fullScreen() const;
    /// Hides the cursor, which then moves without end, and puts it back where it was.
    void captureCursor(bool on);
    void setClipboard(const std::string& text);

    [[nodiscard]] GLFWwindow* handle() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace terray
