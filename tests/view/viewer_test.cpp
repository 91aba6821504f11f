#include "client/view/viewer.h"

#include <ctime>
#include <filesystem>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "client/output/picture.h"
#include "client/render/gl_context.h"
#include "client/stream/flight.h"
#include "client/view/flight_editor.h"
#include "client/view/view.h"
#include "tests/common/temporary_directory.h"
#include "tests/support/analytic_dataset.h"
#include "tests/support/virtual_display.h"

namespace terray {
namespace {

using Kind = WindowEvent::Kind;
using Picture = Grid<Rgba>;

const Camera kStart{.position = {402000, 5197000, 1800}, .heading = Radians(0.4), .pitch = radiansFromDegrees(-25)};

double differing(const Picture& a, const Picture& b) {
    int64_t pixels = 0;
    for (size_t n = 0; n < a.cells().size(); ++n) pixels += a.cells()[n] != b.cells()[n];
    return static_cast<double>(pixels) / static_cast<double>(a.cells().size());
}

class ViewerTest : public testing::Test {
  protected:
    static void SetUpTestSuite() { display_ = std::make_unique<VirtualDisplay>(); }
    static void TearDownTestSuite() { display_.reset(); }
    void TearDown() override { EXPECT_EQ(messages_, "") << "of the driver"; }

    std::unique_ptr<Viewer> open(ViewerOptions options = {}) {
        options.window = {.width = 320, .height = 240, .vsync = false, .debug = true};
        options.engine.render.launch = Launch::raster;
        options.camera = kStart;
        options.pictures = folder_.path();
        auto viewer = std::make_unique<Viewer>(dataset_, shaders_, options);
        collectDebugMessages(messages_);
        return viewer;
    }
    /// Until there is nothing more to draw.
    static void settle(Viewer& viewer) {
        for (int rested = 0, n = 0; rested < 3 && n < 5000; ++n) rested = viewer.turn(0.01) ? 0 : rested + 1;
        EXPECT_EQ(viewer.report().wanted, 0u);
    }
    static void type(Viewer& viewer, Key key, bool control = false) {
        viewer.window().inject({.kind = Kind::keyDown, .key = key, .control = control});
        viewer.window().inject({.kind = Kind::keyUp, .key = key});
        viewer.turnFor(0.02);
    }
    /// The viewer without its panels.
    static void bare(Viewer& viewer) {
        type(viewer, letter('H'));
        type(viewer, letter('O'));
    }
    /// The only file in the folder with this extension.
    std::filesystem::path written(const std::string& extension) const {
        std::filesystem::path found;
        for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
            if (entry.path().extension() == extension) {
                EXPECT_EQ(found, "") << "one alone";
                found = entry.path();
            }
        EXPECT_NE(found, "");
        return found;
    }
    static void hold(Viewer& viewer, Key key, double seconds) {
        viewer.window().inject({.kind = Kind::keyDown, .key = key});
        for (double t = 0; t < seconds; t += 0.05) viewer.turnFor(0.05);
        viewer.window().inject({.kind = Kind::keyUp, .key = key});
        for (int n = 0; n < 100 && viewer.navigator().moving(); ++n) viewer.turnFor(0.1);
    }
    static void drag(Viewer& viewer, MouseButton button, glm::dvec2 from, glm::dvec2 to) {
        viewer.window().inject({.kind = Kind::cursor, .cursor = from});
        viewer.window().inject({.kind = Kind::buttonDown, .button = button});
        for (int n = 1; n <= 4; ++n) {
            viewer.window().inject({.kind = Kind::cursor, .cursor = glm::mix(from, to, n / 4.0)});
            viewer.turnFor(0.02);
        }
        viewer.window().inject({.kind = Kind::buttonUp, .button = button});
        viewer.turnFor(0.02);
    }

    static inline std::unique_ptr<VirtualDisplay> display_;
    test::TemporaryDirectory folder_;
    AnalyticDataset dataset_{{.imageryLevel = 3}};
    ShaderLibrary shaders_;
    std::string messages_;
};

TEST_F(ViewerTest, ShowsWhatIsDrawnWithoutAWindowUnderItsInstruments) {
    Picture shown;
    {
        const auto viewer = open();
        settle(*viewer);
        bare(*viewer);
        settle(*viewer);
        shown = viewer->screenshot();
        EXPECT_TRUE(viewer->firstPictureMs() && viewer->fullDetailMs());
        EXPECT_LE(*viewer->firstPictureMs(), *viewer->fullDetailMs());
        type(*viewer, letter('H'));
        settle(*viewer);
        EXPECT_GT(differing(viewer->screenshot(), shown), 0.1) << "the panel is there again";
    }
    const HeadlessContext context;
    Engine engine(dataset_, shaders_, {}, 320, 240);
    engine.drawFrame(kStart, true);
    // All but the north arrow and the scale bar.
    EXPECT_LT(differing(shown, engine.targets().readSrgb()), 0.12);
    EXPECT_EQ(shown.at(160, 120), engine.targets().readSrgb().at(160, 120));
}

TEST_F(ViewerTest, TakesAPictureThatItsJsonDrawsAgain) {
    const test::TemporaryDirectory dataset;
    dataset_.write(dataset.path());
    ViewerOptions options;
    options.arguments = {dataset.path().string(), "--exaggeration", "2"};
    options.engine.exaggeration = 1.5;  // as the panel has left it
    {
        const auto viewer = open(options);
        hold(*viewer, letter('D'), 0.3);
        type(*viewer, letter('P'));
        EXPECT_NE(viewer->notice().find(".png"), std::string::npos) << viewer->notice();
        settle(*viewer);
    }
    const std::string again = (dataset / "again.png").string();
    ASSERT_EQ(runView({"--reproduce", written(".json").string(), "--out", again}), ExitCode::ok);
    EXPECT_TRUE(readPicture(again) == readPicture(written(".png")));
    EXPECT_EQ(readPicture(again).width(), 320);
    const std::string larger = (dataset / "larger.png").string();
    ASSERT_EQ(runView({"--reproduce", written(".json").string(), "--size", "400x300", "--out", larger}), ExitCode::ok);
    EXPECT_EQ(readPicture(larger).width(), 400);
}

TEST_F(ViewerTest, TakesALargePictureInPartsThatIsTheOneOfOnePiece) {
    const test::TemporaryDirectory dataset;
    dataset_.write(dataset.path());
    ViewerOptions options;
    options.arguments = {dataset.path().string(), "--part-size", "300x130"};
    options.part = glm::ivec2(300, 130);
    options.remembered = Json::parse(R"({"picture_size": 1})").value();
    {
        const auto viewer = open(options);
        bare(*viewer);
        settle(*viewer);
        const Picture before = viewer->screenshot();
        type(*viewer, letter('P'));  // 640 x 480: 3 x 4 parts
        EXPECT_EQ(viewer->notice(), "");
        EXPECT_GT(differing(viewer->screenshot(), before), 0) << "it says how far it is";
        EXPECT_LT(differing(viewer->screenshot(), before), 0.3) << "over what was there";
        type(*viewer, Key::escape);
        EXPECT_EQ(viewer->notice(), "the picture was given up");
        EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
        type(*viewer, letter('P'));
        for (int n = 0; n < 20; ++n) viewer->turnFor(0.02);
        EXPECT_NE(viewer->notice().find(".png"), std::string::npos) << viewer->notice();
        settle(*viewer);
        EXPECT_LT(differing(viewer->screenshot(), before), 0.3) << "the window is as it was, but for the notice";
    }
    const Picture taken = readPicture(written(".png"));
    EXPECT_EQ(taken.size(), (GridSize{640, 480}));
    const std::string again = (dataset / "again.png").string();
    ASSERT_EQ(runView({"--reproduce", written(".json").string(), "--out", again}), ExitCode::ok);
    EXPECT_TRUE(readPicture(again) == taken) << "byte by byte";
}

TEST_F(ViewerTest, RecordsWhatWasFlownAndReplaysIt) {
    const auto viewer = open();
    settle(*viewer);
    type(*viewer, letter('R'));
    std::vector<Camera> flown;
    viewer->window().inject({.kind = Kind::keyDown, .key = letter('W')});
    for (int n = 0; n < 10; ++n) {
        viewer->turnFor(0.05);
        flown.push_back(viewer->navigator().camera());
    }
    viewer->window().inject({.kind = Kind::keyUp, .key = letter('W')});
    type(*viewer, letter('R'));
    const Flight flight = loadFlight(written(".json"));
    // The start is one turn before the first of these.
    for (size_t n = 0; n < flown.size(); ++n) {
        const double seconds = 0.05 * static_cast<double>(n + 1);
        EXPECT_LT(glm::distance(flight.at(seconds).position, flown[n].position), 1e-6) << n;
    }
    for (int n = 0; n < 100 && viewer->navigator().moving(); ++n) viewer->turnFor(0.1);
    type(*viewer, letter('L'));
    viewer->turnFor(0.23);
    EXPECT_LT(glm::distance(viewer->navigator().camera().position, flight.at(0.25).position), 1e-6);
}

TEST_F(ViewerTest, EditsAFlightKeyByKeyShowsItsPathAndSavesIt) {
    const auto viewer = open();
    settle(*viewer);
    bare(*viewer);
    type(*viewer, letter('K'));
    ASSERT_NE(viewer->editor(), nullptr);
    type(*viewer, Key::insert);
    hold(*viewer, letter('S'), 1);  // back, so that the path lies ahead
    type(*viewer, Key::insert);
    hold(*viewer, letter('D'), 1);
    type(*viewer, Key::insert);
    type(*viewer, Key::comma);
    const Flight three = viewer->editor()->flight();
    ASSERT_EQ(three.keys.size(), 3u);
    EXPECT_EQ(viewer->navigator().camera(), three.keys[1].camera) << "the camera follows";
    hold(*viewer, letter('E'), 0.5);
    const Camera higher = viewer->navigator().camera();
    type(*viewer, Key::enter);
    EXPECT_EQ(viewer->editor()->flight().keys[1].camera, asWritten(higher));
    type(*viewer, Key::period);
    type(*viewer, Key::remove);
    EXPECT_EQ(viewer->editor()->flight().keys.size(), 2u);
    type(*viewer, letter('Z'), true);
    EXPECT_EQ(viewer->editor()->flight().keys.size(), 3u);
    type(*viewer, letter('S'), true);
    const Flight saved = loadFlight(written(".json"));
    EXPECT_EQ(saved.keys, viewer->editor()->flight().keys);

    // Played, the camera goes where the file says.
    type(*viewer, letter('L'));
    EXPECT_TRUE(viewer->editor()->playing());
    viewer->turnFor(1);
    EXPECT_LT(glm::distance(viewer->navigator().camera().position, saved.at(viewer->editor()->seconds()).position),
              1e-6);
    type(*viewer, letter('L'));
    EXPECT_FALSE(viewer->editor()->playing());

    // From the side the path is in the picture, and it goes with the editor.
    type(*viewer, Key::home);
    for (int n = 0; n < 100 && viewer->navigator().flying(); ++n) viewer->turnFor(0.1);
    settle(*viewer);
    const Picture marked = viewer->engine().targets().readSrgb();
    type(*viewer, letter('K'));
    EXPECT_EQ(viewer->editor(), nullptr);
    settle(*viewer);
    const double share = differing(viewer->engine().targets().readSrgb(), marked);
    EXPECT_GT(share, 1e-4);
    EXPECT_LT(share, 0.02);
    // What was edited last is what L replays, and what the editor opens again.
    type(*viewer, letter('K'));
    EXPECT_EQ(viewer->editor()->flight().keys, saved.keys);
}

TEST_F(ViewerTest, EditsWhatWasRecordedAndSaysWhyItCannot) {
    const auto viewer = open();
    settle(*viewer);
    type(*viewer, letter('R'));
    hold(*viewer, letter('W'), 0.5);
    type(*viewer, letter('R'));
    const std::filesystem::path recorded = written(".json");
    type(*viewer, letter('K'));
    EXPECT_EQ(viewer->editor()->flight(), loadFlight(recorded));
    type(*viewer, Key::insert);  // between two pictures
    EXPECT_TRUE(viewer->editor()->changed());
    type(*viewer, letter('K'));
    EXPECT_EQ(viewer->editor(), nullptr);
    type(*viewer, Key::insert);  // is nobody's
    type(*viewer, letter('K'));
    for (size_t n = viewer->editor()->flight().keys.size(); n > 1; --n) type(*viewer, Key::remove);
    type(*viewer, Key::remove);
    EXPECT_EQ(viewer->notice(), "the only key of a flight cannot be deleted");
    EXPECT_TRUE(std::filesystem::exists(recorded));
}

TEST_F(ViewerTest, RecallsBookmarksAlsoOfAnEarlierRun) {
    ViewerOptions options;
    options.bookmarks = folder_ / "bookmarks" / "some.json";
    {
        const auto viewer = open(options);
        type(*viewer, letter('4'), true);
        EXPECT_EQ(viewer->notice(), "bookmark 4 stored");
        type(*viewer, letter('5'));
        EXPECT_EQ(viewer->notice(), "bookmark 5 is empty: Ctrl+5 stores it");
    }
    const auto viewer = open(options);
    hold(*viewer, letter('S'), 1);
    EXPECT_GT(glm::distance(viewer->navigator().camera().position, kStart.position), 100);
    type(*viewer, letter('4'));
    for (int n = 0; n < 100 && viewer->navigator().flying(); ++n) viewer->turnFor(0.1);
    EXPECT_LT(glm::distance(viewer->navigator().camera().position, kStart.position), 1e-3);
}

TEST_F(ViewerTest, FreezesWhatIsSelectedAndShowsItsBoxes) {
    const auto viewer = open();
    settle(*viewer);
    const size_t nodes = viewer->engine().nodes().size();
    type(*viewer, letter('F'));
    hold(*viewer, letter('S'), 2);
    EXPECT_EQ(viewer->engine().nodes().size(), nodes);
    for (int n = 0; n < 5; ++n) viewer->turnFor(0.02);
    const Picture frozen = viewer->screenshot();
    type(*viewer, letter('F'));
    settle(*viewer);
    EXPECT_GT(differing(viewer->screenshot(), frozen), 0.05);
}

TEST_F(ViewerTest, HoldsItsFrameRateByCoarserPicturesThatSharpenAtRest) {
    ViewerOptions options;
    options.targetFps = 1000;  // no machine does that
    const auto viewer = open(options);
    settle(*viewer);
    viewer->window().inject({.kind = Kind::keyDown, .key = letter('W')});
    for (int n = 0; n < 30; ++n) viewer->turnFor(0.01);
    EXPECT_EQ(viewer->engine().targets().width(), 160);
    EXPECT_NEAR(viewer->engine().options().selection.tolerance.value(), 4 * 2.0 / 3, 1e-9);
    viewer->window().inject({.kind = Kind::keyUp, .key = letter('W')});
    for (int n = 0; n < 100 && viewer->navigator().moving(); ++n) viewer->turnFor(0.1);
    for (int n = 0; n < 5; ++n) viewer->turnFor(0.1);
    EXPECT_EQ(viewer->engine().targets().width(), 320);
    EXPECT_NEAR(viewer->engine().options().selection.tolerance.value(), 2.0 / 3, 1e-9);
}

TEST_F(ViewerTest, FliesAheadAndThePictureFollows) {
    const auto viewer = open();
    settle(*viewer);
    const Picture before = viewer->screenshot();
    hold(*viewer, letter('W'), 1);
    settle(*viewer);
    const glm::dvec3 way = viewer->navigator().camera().position - kStart.position;
    EXPECT_GT(glm::length(way), 200);
    EXPECT_NEAR(glm::dot(glm::normalize(way), viewOf(kStart, 1, 1).forward), 1, 1e-3);
    EXPECT_GT(differing(viewer->screenshot(), before), 0.5);
}

TEST_F(ViewerTest, GrabbedGroundStaysUnderTheCursorWhilePannedAndOrbited) {
    const auto viewer = open();
    settle(*viewer);
    viewer->window().inject({.kind = Kind::keyDown, .key = Key::f3});
    for (const MouseButton button : {MouseButton::left, MouseButton::right}) {
        const glm::dvec2 from(160.5, 150.5), to(200.5, 130.5);
        const auto grabbed = viewer->engine().placeAt(160, 150);
        ASSERT_TRUE(grabbed.has_value());
        drag(*viewer, button, from, to);
        settle(*viewer);
        const bool panned = button == MouseButton::left;
        const auto now = panned ? viewer->engine().placeAt(200, 130) : viewer->engine().placeAt(160, 150);
        ASSERT_TRUE(now.has_value());
        // A pixel is about 6 m there, and 15 m along the slanting ground.
        EXPECT_LT(glm::distance(*grabbed, *now), 15);
        EXPECT_NE(viewer->navigator().camera(), kStart);
    }
}

TEST_F(ViewerTest, ResizesAndFillsTheScreen) {
    const auto viewer = open();
    const auto until = [&](glm::ivec2 size) {
        for (int n = 0; n < 200 && viewer->window().size() != size; ++n) viewer->turn(0.01);
        settle(*viewer);
        EXPECT_EQ(viewer->window().size(), size);
        EXPECT_EQ(glm::ivec2(viewer->engine().targets().width(), viewer->engine().targets().height()), size);
    };
    until({320, 240});
    viewer->window().setSize(400, 300);
    until({400, 300});
    viewer->window().inject({.kind = Kind::keyDown, .key = Key::f11});
    until({VirtualDisplay::kWidth, VirtualDisplay::kHeight});
    viewer->window().inject({.kind = Kind::keyDown, .key = Key::f11});
    until({400, 300});
}

TEST_F(ViewerTest, TakesNoTimeWhenNothingMoves) {
    const auto viewer = open();
    settle(*viewer);
    const std::clock_t before = std::clock();
    int frames = 0;
    for (int n = 0; n < 4; ++n) frames += viewer->turn(0.25) ? 1 : 0;
    EXPECT_EQ(frames, 0);
    // Of a second; this machine's other programs do not count.
    EXPECT_LT(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC, 0.05);
}

TEST_F(ViewerTest, HomeShowsTheWholeDatasetAndQuitEnds) {
    const auto viewer = open();
    viewer->window().inject({.kind = Kind::keyDown, .key = Key::home});
    viewer->turnFor(0.05);
    for (int n = 0; n < 100 && viewer->navigator().flying(); ++n) viewer->turnFor(0.1);
    EXPECT_GT(viewer->navigator().camera().position.z, 4000);
    EXPECT_FALSE(viewer->window().closing());
    viewer->window().inject({.kind = Kind::keyDown, .key = letter('Q'), .control = true});
    viewer->turnFor(0.05);
    EXPECT_TRUE(viewer->window().closing());
}

TEST(ViewerWithoutADisplay, NamesWhatToDoInstead) {
    const test::TemporaryDirectory folder;
    AnalyticDataset({.finestLevel = 1}).write(folder.path());
    try {
        (void)runView({folder.path().string()});
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::display);
        EXPECT_NE(std::string(error.what()).find("--headless"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace terray
