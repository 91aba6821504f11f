#include "client/view/controls.h"

#include <limits>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "client/navigation/grab.h"
#include "tests/navigation/hills.h"

namespace terray::test {
namespace {

using Kind = WindowEvent::Kind;

/// Controls of a camera over level ground at 0, in a window of 640 x 480.
class ControlsTest : public testing::Test {
  protected:
    ControlsTest() { controls_.setWindowHeight(480); }

    std::optional<glm::dvec3> pick(glm::dvec2 pixel) const {
        const View view = drawn(navigator_.camera());
        const glm::dvec3 ray = view.direction(pixel.x, pixel.y);
        if (ray.z >= 0) return {};
        return view.eye - view.eye.z / ray.z * ray;
    }
    void move(double x, double y) { controls_.handle({.kind = Kind::cursor, .cursor = {x, y}}, now_); }
    void press(MouseButton button) { controls_.handle({.kind = Kind::buttonDown, .button = button}, now_); }
    void wait(double seconds) { now_ += seconds; }
    void release(MouseButton button) { controls_.handle({.kind = Kind::buttonUp, .button = button}, now_); }
    std::optional<CommandEvent> type(Key key, bool control = false) {
        const auto command = controls_.handle({.kind = Kind::keyDown, .key = key, .control = control}, now_);
        controls_.handle({.kind = Kind::keyUp, .key = key}, now_);
        return command;
    }
    glm::dvec2 pixel(const glm::dvec3& point) const { return pixelOf(drawn(navigator_.camera()), point).value(); }

    Hills level_{0};
    Navigator navigator_{sceneOver(level_), {.position = {5000, 5000, 1000}, .pitch = radiansFromDegrees(-40)}};
    Controls controls_{navigator_, [this](glm::dvec2 pixel) { return pick(pixel); }};
    double now_ = 0;
};

TEST_F(ControlsTest, HeldKeysAreMotionAndOppositeOnesNone) {
    const auto hold = [&](Key key) { controls_.handle({.kind = Kind::keyDown, .key = key}, 0); };
    hold(letter('W'));
    hold(letter('D'));
    hold(Key::shift);
    EXPECT_EQ(controls_.motion(), (Motion{.right = 1, .ahead = 1, .fast = true}));
    hold(letter('A'));
    EXPECT_EQ(controls_.motion().right, 0);
    controls_.handle({.kind = Kind::focusLost}, 0);
    EXPECT_EQ(controls_.motion(), Motion{});
}

TEST_F(ControlsTest, AKeyWithControlIsNoMotion) {
    controls_.handle({.kind = Kind::keyDown, .key = letter('Q'), .control = true}, 0);
    EXPECT_EQ(controls_.motion(), Motion{});
}

TEST_F(ControlsTest, DraggingLooksAroundWhenFlyingFree) {
    move(320, 240);
    press(MouseButton::left);
    move(330, 240);
    EXPECT_NEAR(degreesFromRadians(navigator_.camera().heading), 10 * 45.0 / 480, 1e-9);
    move(330, 230);
    EXPECT_NEAR(degreesFromRadians(navigator_.camera().pitch), -40 + 10 * 45.0 / 480, 1e-9);
    release(MouseButton::left);
    const Camera rested = navigator_.camera();
    move(100, 100);
    EXPECT_EQ(navigator_.camera(), rested);
}

TEST_F(ControlsTest, DraggedGroundStaysUnderTheCursor) {
    for (const Key mode : {Key::f3, Key::f4}) {
        wait(1);
        type(mode);
        move(320, 300);
        const glm::dvec3 point = pick({320, 300}).value();
        press(MouseButton::left);
        for (int n = 0; n <= 20; ++n) {
            move(320 + 5 * n, 300 - 2 * n);
            EXPECT_LT(glm::distance(pixel(point), controls_.cursor()), 1e-6);
        }
        release(MouseButton::left);
    }
}

TEST_F(ControlsTest, OrbitingKeepsTheGroundUnderTheCursorWhichStays) {
    type(Key::f3);
    move(400, 300);
    const glm::dvec3 point = pick({400, 300}).value();
    press(MouseButton::right);
    EXPECT_TRUE(controls_.capturesCursor());
    for (int n = 0; n < 20; ++n) {
        move(400 + 20 * n, 300);
        EXPECT_LT(glm::distance(pixel(point), glm::dvec2(400, 300)), 1e-6);
    }
    EXPECT_EQ(controls_.cursor(), glm::dvec2(400, 300));
    release(MouseButton::right);
    EXPECT_FALSE(controls_.capturesCursor());
    EXPECT_GT(degreesFromRadians(navigator_.camera().heading), 90) << "it went around";
}

TEST_F(ControlsTest, TheWheelZoomsToTheCursorOrSetsTheSpeed) {
    controls_.handle({.kind = Kind::wheel, .wheel = 1}, 0);
    EXPECT_NEAR(navigator_.speedFactor(), 1.25, 1e-12);
    type(Key::f3);
    move(500, 400);
    const glm::dvec3 point = pick({500, 400}).value();
    const double before = glm::distance(navigator_.camera().position, point);
    controls_.handle({.kind = Kind::wheel, .wheel = 2}, 0);
    EXPECT_NEAR(glm::distance(navigator_.camera().position, point), 0.64 * before, 1e-6);
    EXPECT_LT(glm::distance(pixel(point), glm::dvec2(500, 400)), 1e-6);
}

TEST_F(ControlsTest, ADoubleClickFliesThereAndTwoSlowOnesDoNot) {
    const auto click = [&](double seconds) {
        now_ += seconds;
        press(MouseButton::left);
        release(MouseButton::left);
    };
    move(320, 400);
    click(1);
    click(1);
    EXPECT_FALSE(navigator_.flying());
    click(0.2);
    EXPECT_TRUE(navigator_.flying());
}

TEST_F(ControlsTest, KeysAreCommands) {
    EXPECT_EQ(type(Key::f1), CommandEvent{Command::help});
    EXPECT_EQ(type(Key::home), CommandEvent{Command::home});
    EXPECT_EQ(type(letter('3')), (CommandEvent{Command::recall, 3}));
    EXPECT_EQ(type(letter('9'), true), (CommandEvent{Command::store, 9}));
    EXPECT_EQ(type(letter('Q'), true), CommandEvent{Command::quit});
    EXPECT_EQ(type(letter('Q')), std::nullopt) << "down";
    EXPECT_EQ(type(letter('0')), std::nullopt);
    EXPECT_EQ(type(letter('K')), CommandEvent{Command::edit});
    EXPECT_EQ(type(Key::insert), CommandEvent{Command::insertKey});
    EXPECT_EQ(type(letter('S'), true), CommandEvent{Command::save});
    EXPECT_EQ(type(letter('S')), std::nullopt) << "backwards";
    type(Key::f5);
    EXPECT_EQ(navigator_.mode(), NavigationMode::walk);
}

TEST_F(ControlsTest, AGamepadFliesAndLooks) {
    controls_.handle(Gamepad{.leftStick = {0.5, -1}, .rightStick = {1, 0}, .rightTrigger = 0.25, .a = true}, 0.1);
    EXPECT_EQ(controls_.motion(), (Motion{.right = 0.5, .ahead = 1, .up = 0.25, .fast = true}));
    EXPECT_NEAR(navigator_.camera().heading.value(), 0.15, 1e-12);
}

}  // namespace
}  // namespace terray::test
