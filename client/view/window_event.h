#pragma once

#include <cstdint>
#include <optional>

#include <glm/vec2.hpp>

namespace terray {

/// The keys that mean something to the viewer. Letters, digits, comma, period and space are their ASCII
/// codes, letters as capitals.
enum class Key : uint16_t {
    none = 0,
    space = ' ',
    comma = ',',
    period = '.',
    escape = 256,
    enter,
    tab,
    home,
    pageUp,
    pageDown,
    left,
    right,
    up,
    down,
    insert,
    remove,
    shift,
    f1,
    f2,
    f3,
    f4,
    f5,
    f11,
};
[[nodiscard]] constexpr Key letter(char capital) {
    return static_cast<Key>(capital);
}
inline constexpr size_t kKeys = 320;  ///< above every value of Key

enum class MouseButton : uint8_t { left, right, middle };

/// Something that a person did in the window. Pixels are the framebuffer's, from its upper-left corner.
struct WindowEvent {
    enum class Kind : uint8_t { keyDown, keyUp, buttonDown, buttonUp, cursor, wheel, exposed, focusLost };
    Kind kind = Kind::exposed;
    Key key = Key::none;  ///< keyDown, keyUp; held keys are not told again
    bool control = false;
    MouseButton button = MouseButton::left;
    glm::dvec2 cursor{0};  ///< cursor: where it is now
    double wheel = 0;      ///< wheel: notches away from the person
};

/// Sticks and triggers of a gamepad, -1 .. 1, resting ones exactly 0: right and down are positive.
struct Gamepad {
    glm::dvec2 leftStick{0};
    glm::dvec2 rightStick{0};
    double leftTrigger = 0;  ///< 0 .. 1
    double rightTrigger = 0;
    bool a = false;
    bool leftShoulder = false;
    bool rightShoulder = false;
    bool operator==(const Gamepad&) const = default;
};

}  // namespace terray
