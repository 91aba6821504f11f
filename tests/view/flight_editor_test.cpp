#include "client/view/flight_editor.h"

#include <gtest/gtest.h>

#include "client/view/flight_marks.h"

namespace terray {
namespace {

Camera at(double x) {
    return {.position = {x, 2 * x, 500}, .heading = Radians(0.25), .pitch = Radians(-0.5)};
}

/// Keys at x = 0, 100, 200, ... and as many seconds 0, 5, 10, ...
FlightEditor withKeys(size_t count) {
    FlightEditor editor({});
    for (size_t n = 0; n < count; ++n) EXPECT_TRUE(editor.append(at(100.0 * static_cast<double>(n))));
    return editor;
}

std::vector<double> times(const FlightEditor& editor) {
    std::vector<double> seconds;
    for (const FlightKey& key : editor.flight().keys) seconds.push_back(key.seconds);
    return seconds;
}

TEST(FlightEditor, AddsKeysBehindTheLastOneBehindTheSelectedOneAndAtItsMoment) {
    FlightEditor editor = withKeys(3);
    EXPECT_EQ(times(editor), (std::vector<double>{0, 5, 10}));
    EXPECT_EQ(editor.selected(), 2u);
    editor.select(0);
    ASSERT_TRUE(editor.insert(at(1)));
    EXPECT_EQ(times(editor), (std::vector<double>{0, 2.5, 5, 10}));
    EXPECT_EQ(editor.selected(), 1u);
    EXPECT_EQ(editor.seconds(), 2.5);
    EXPECT_EQ(editor.camera(), asWritten(at(1)));
    editor.select(3);
    ASSERT_TRUE(editor.insert(at(2)));
    EXPECT_EQ(times(editor).back(), 15) << "behind the last one there is no half way";
    editor.scrub(7);
    ASSERT_TRUE(editor.addHere(at(3)));
    EXPECT_EQ(times(editor), (std::vector<double>{0, 2.5, 5, 7, 10, 15}));
    EXPECT_EQ(editor.selected(), 3u);
}

TEST(FlightEditor, MovesDeletesAndRetimesTheSelectedKey) {
    FlightEditor editor = withKeys(4);
    editor.select(1);
    ASSERT_TRUE(editor.move(at(-7)));
    EXPECT_EQ(editor.flight().keys[1].camera, asWritten(at(-7)));
    ASSERT_TRUE(editor.retime(7, false));
    EXPECT_EQ(times(editor), (std::vector<double>{0, 7, 10, 15}));
    ASSERT_TRUE(editor.retime(8, true));
    EXPECT_EQ(times(editor), (std::vector<double>{0, 8, 11, 16}));
    EXPECT_EQ(editor.seconds(), 8) << "the moment goes with the key";
    ASSERT_TRUE(editor.setDuration(32));
    EXPECT_EQ(times(editor), (std::vector<double>{0, 16, 22, 32}));
    ASSERT_TRUE(editor.remove());
    EXPECT_EQ(times(editor), (std::vector<double>{0, 22, 32}));
    EXPECT_EQ(editor.selected(), 1u);
    editor.select(2);
    ASSERT_TRUE(editor.remove());
    EXPECT_EQ(editor.selected(), 1u) << "the last one that there is";
}

TEST(FlightEditor, UndoesEveryEditAndDoesItAgain) {
    FlightEditor editor = withKeys(3);
    editor.select(1);
    std::vector<Flight> states{editor.flight()};
    const auto done = [&](const Result<void>& result) {
        EXPECT_TRUE(result);
        states.push_back(editor.flight());
    };
    done(editor.insert(at(5)));
    done(editor.move(at(6)));
    done(editor.retime(8, true));
    done(editor.setDuration(100));
    done(editor.remove());
    done(editor.thin(Metres(1e6), Radians(3)));
    editor.replace({.dataset = "", .name = "other", .keys = {{1, at(1)}}});
    for (size_t n = states.size(); n-- > 0;) {
        editor.undo();
        EXPECT_EQ(editor.flight(), states[n]) << n;
    }
    while (editor.canRedo()) editor.redo();
    EXPECT_EQ(editor.flight().name, "other");
    editor.undo();
    ASSERT_TRUE(editor.append(at(9)));
    EXPECT_FALSE(editor.canRedo()) << "another way was taken";
}

TEST(FlightEditor, KnowsWhichFlightItHasComeFrom) {
    FlightEditor editor = withKeys(2);
    const uint64_t first = editor.origin();
    ASSERT_TRUE(editor.append(at(3)));
    EXPECT_EQ(editor.origin(), first) << "an edit makes it no other flight";
    editor.replace({.dataset = "", .name = "other", .keys = {{1, at(1)}}});
    const uint64_t second = editor.origin();
    EXPECT_NE(second, first);
    editor.undo();
    EXPECT_EQ(editor.origin(), first) << "a file of the other flight must not be written over with this one";
    editor.redo();
    EXPECT_EQ(editor.origin(), second);
    editor.undo();
    editor.replace({.dataset = "", .name = "third", .keys = {{1, at(1)}}});
    EXPECT_NE(editor.origin(), first);
    EXPECT_NE(editor.origin(), second);
}

TEST(FlightEditor, RefusesWithASentenceAndChangesNothing) {
    FlightEditor empty({});
    EXPECT_EQ(empty.move(at(0)).failure().message, "the flight has no key yet: add one first");
    EXPECT_FALSE(empty.setDuration(10));
    EXPECT_FALSE(empty.camera());
    empty.play();
    EXPECT_FALSE(empty.playing());
    EXPECT_FALSE(empty.canUndo());

    FlightEditor editor = withKeys(2);
    const Flight before = editor.flight();
    const uint64_t revision = editor.revision();
    editor.saved();
    EXPECT_NE(editor.retime(-1, false).failure().message, "");
    EXPECT_FALSE(editor.retime(0, false)) << "another key is there";
    EXPECT_FALSE(editor.addHere(at(3))) << "likewise";
    EXPECT_FALSE(editor.setDuration(-3));
    EXPECT_FALSE(editor.thin(Metres(0), Radians(1)));
    EXPECT_FALSE(editor.thin(Metres(1), Radians(1))) << "there is none to leave out";
    EXPECT_EQ(editor.flight(), before);
    EXPECT_EQ(editor.revision(), revision);
    EXPECT_FALSE(editor.changed());
    ASSERT_TRUE(editor.remove());
    EXPECT_EQ(editor.remove().failure().message, "the only key of a flight cannot be deleted");
}

TEST(FlightEditor, PlaysFromItsMomentToTheEndAndThenFromTheStart) {
    FlightEditor editor = withKeys(3);
    editor.scrub(9);
    editor.play();
    editor.advance(0.5);
    EXPECT_EQ(editor.seconds(), 9.5);
    EXPECT_TRUE(editor.playing());
    editor.advance(2);
    EXPECT_EQ(editor.seconds(), 10);
    EXPECT_FALSE(editor.playing());
    editor.play();
    EXPECT_EQ(editor.seconds(), 0);
    editor.pause();
    editor.advance(1);
    EXPECT_EQ(editor.seconds(), 0);
    editor.scrub(1e9);
    EXPECT_EQ(editor.seconds(), 10);
}

TEST(FlightEditor, GoesFromKeyToKey) {
    FlightEditor editor = withKeys(3);
    editor.scrub(6);
    editor.selectPrevious();
    EXPECT_EQ(editor.selected(), 1u);
    editor.selectNext();
    EXPECT_EQ(editor.selected(), 2u);
    editor.selectNext();
    EXPECT_EQ(editor.selected(), 2u) << "there is no other";
    editor.selectPrevious();
    editor.selectPrevious();
    editor.selectPrevious();
    EXPECT_EQ(editor.selected(), 0u);
}

TEST(FlightEditor, ForgetsTheOldestWaysBackToLongFlights) {
    Flight flight;
    for (int n = 0; n < 100'000; ++n) flight.keys.push_back({0.01 * n, at(n)});
    FlightEditor editor(flight);
    for (int n = 0; n < 30; ++n) ASSERT_TRUE(editor.append(at(n)));
    int undone = 0;
    for (; editor.canUndo(); ++undone) editor.undo();
    EXPECT_EQ(undone, 10) << "a million keys";
}

TEST(FlightMarks, AreAPathBallsAndTheSelectedKeyAndNothingWithoutKeys) {
    EXPECT_TRUE(flightMarks({}, {}).empty());
    EXPECT_EQ(flightMarks(withKeys(1).flight(), 0).size(), 3u) << "a path of one point, the selected key, its view";
    const std::vector<OverlayMesh> marks = flightMarks(withKeys(5).flight(), 2);
    ASSERT_EQ(marks.size(), 4u);
    for (const OverlayMesh& mesh : marks) {
        EXPECT_FALSE(mesh.indices.empty());
        EXPECT_GT(mesh.leastPixels, 1);
    }
    Flight recorded;
    for (int n = 0; n < 20'000; ++n) recorded.keys.push_back({0.02 * n, at(n)});
    EXPECT_EQ(flightMarks(recorded, {}).size(), 1u) << "the path alone";
}

}  // namespace
}  // namespace terray
