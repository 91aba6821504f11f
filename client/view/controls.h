#pragma once

#include <array>
#include <functional>
#include <optional>

#include "client/navigation/navigator.h"
#include "client/view/window_event.h"

namespace terray {

/// What a person asks for beside flying.
enum class Command : uint8_t {
    quit,
    help,
    panel,
    overlay,
    freeze,
    measure,
    fullScreen,
    vsync,
    home,
    north,
    goTo,
    copyCamera,
    picture,
    record,
    replay,
    edit,
    insertKey,
    moveKey,
    deleteKey,
    previousKey,
    nextKey,
    undo,
    redo,
    save,
    recall,
    store,
    cancel,
};
struct CommandEvent {
    Command command = Command::cancel;
    int number = 0;  ///< recall, store: 1 to 9
    bool operator==(const CommandEvent&) const = default;
};

/// Turns what happens in a window into flight: the table of client/README.md, "Flying". No window, no GL.
class Controls {
  public:
    /// The ground under a pixel of the window, a point of the drawn world; none in the sky.
    using Pick = std::function<std::optional<glm::dvec3>(glm::dvec2 pixel)>;
    /// @param navigator  outlives this object
    Controls(Navigator& navigator, Pick pick) : navigator_(navigator), pick_(std::move(pick)) {}

    void setWindowHeight(int pixels) { windowHeight_ = pixels; }
    /// @param seconds  on any clock that does not go back, for double clicks  @return what is asked for beside flying
    std::optional<CommandEvent> handle(const WindowEvent& event, double seconds);
    /// What the gamepad does for so long.
    void handle(const Gamepad& gamepad, double seconds);
    /// What is held, keys and gamepad together.
    [[nodiscard]] Motion motion() const;
    /// Forgets what is held: another window, or a field of text, has the keyboard.
    void letGo();
    /// Where the cursor is, pixels of the window. While it is captured: where it was.
    [[nodiscard]] glm::dvec2 cursor() const { return cursor_; }
    /// Whether the cursor should be hidden, and move without end.
    [[nodiscard]] bool capturesCursor() const { return drag_ == Drag::orbit; }

  private:
    enum class Drag : uint8_t { none, look, pan, orbit };
    std::optional<CommandEvent> keyDown(const WindowEvent& event);
    void buttonDown(MouseButton button, double seconds);
    void beginDrag(MouseButton button);
    void moveTo(glm::dvec2 cursor);
    void wheel(double notches);
    [[nodiscard]] bool held(Key key) const { return held_[static_cast<size_t>(key)]; }
    [[nodiscard]] bool grabs() const;

    Navigator& navigator_;
    Pick pick_;
    int windowHeight_ = 1;
    std::array<bool, kKeys> held_{};
    Gamepad gamepad_;
    Drag drag_ = Drag::none;
    MouseButton dragButton_ = MouseButton::left;
    glm::dvec2 cursor_{0};
    glm::dvec2 moved_{0};  ///< where the window last said the cursor is
    double lastClick_ = -1e9;
    glm::dvec2 lastClickAt_{0};
};

}  // namespace terray
