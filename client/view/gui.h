#pragma once

#include "client/view/window.h"

namespace terray {

/// Dear ImGui over a window: panels are declared between begin() and end(), and drawn by draw(). It hears of the
/// window's events by itself. One at a time; main thread.
class Gui {
  public:
    explicit Gui(Window& window);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    void begin();
    void end();
    /// Over what the back buffer holds; may be called again for the same frame.
    void draw();

    /// Whether a panel, not the ground, has the mouse or the keyboard.
    [[nodiscard]] bool hasMouse() const;
    [[nodiscard]] bool hasKeyboard() const;
};

}  // namespace terray
