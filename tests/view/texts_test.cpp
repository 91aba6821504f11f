// What the viewer says and remembers: arguments, settings, read-outs, frame times.

#include <array>
#include <cstdlib>

#include <gtest/gtest.h>

#include "client/view/arguments.h"
#include "client/view/frame_history.h"
#include "client/view/readout.h"
#include "client/view/view_options.h"
#include "client/view/view_settings.h"
#include "common/error.h"
#include "tests/navigation/hills.h"

namespace terray::test {
namespace {

TEST(ViewerArguments, LoseOptionsInBothSpellingsAndKeepTheRest) {
    const Arguments arguments{"alps", "--sun", "315,40", "--track", "a.gpx", "b.gpx", "--sun=1,2", "--sunny"};
    EXPECT_TRUE(gives(arguments, "sun"));
    EXPECT_FALSE(gives(arguments, "su"));
    constexpr std::array<std::string_view, 1> kSun = {"sun"};
    EXPECT_EQ(withoutOptions(arguments, kSun), (Arguments{"alps", "--track", "a.gpx", "b.gpx", "--sunny"}));
    EXPECT_EQ(withOptions({"alps"}, {{"sun", "-5,40"}}), (Arguments{"alps", "--sun=-5,40"}));
    EXPECT_EQ(std::stod(numberText(0.1 + 0.2)), 0.1 + 0.2);
}

ViewSettings changed() {
    DatasetMetadata metadata;
    metadata.crsWkt = "some";
    ViewSettings settings = settingsFrom({}, metadata);
    settings.engine.selection.tolerance = Pixels(1.7);
    settings.engine.render.shading.mode = Shading::slope;
    settings.engine.render.surface = Surface::columns;
    settings.engine.render.shadows = ShadowOptions();
    settings.engine.render.visualRange = Metres(54321);
    settings.engine.render.sky = true;
    settings.engine.exaggeration = 1.23;
    settings.engine.earth.shape = EarthShape::curved;
    settings.sun.azimuthDegrees = 12.5;
    settings.sun.elevationDegrees = 3;
    settings.settle();
    return settings;
}

EngineOptions parsed(const Arguments& arguments) {
    ViewOptions options;
    EXPECT_TRUE(options.parse(arguments));
    return options.engine.options(true);
}

void expectSame(const EngineOptions& a, const EngineOptions& b) {
    EXPECT_EQ(a.selection.tolerance, b.selection.tolerance);
    EXPECT_EQ(a.render.shading.mode, b.render.shading.mode);
    EXPECT_EQ(a.render.surface, b.render.surface);
    EXPECT_EQ(a.render.shadows.has_value(), b.render.shadows.has_value());
    EXPECT_EQ(a.render.visualRange, b.render.visualRange);
    EXPECT_EQ(a.render.sky, b.render.sky);
    EXPECT_EQ(a.exaggeration, b.exaggeration);
    EXPECT_EQ(a.earth, b.earth);
    EXPECT_EQ(a.sunTime, b.sunTime);
    if (a.sunTime) return;  // it takes the direction's place
    EXPECT_EQ(a.render.sunDirection, b.render.sunDirection) << "to the last bit: pictures are reproduced";
}

TEST(ViewerSettings, ComeBackFromTheirTexts) {
    ViewSettings settings = changed();
    const Arguments given{"alps", "--shading", "contours", "--contour-interval=50", "--sun-time", "2026-06-21T12:00Z"};
    expectSame(parsed(withEngineTexts(given, settings)), settings.engine);
    settings.sun.byTime = true;
    settings.sun.setTime(*parseUtcTime("2024-02-29T05:06Z"));
    settings.settle();
    expectSame(parsed(withEngineTexts(given, settings)), settings.engine);
}

TEST(ViewerSettings, AreRememberedWhereTheCommandLineSaysNothing) {
    ViewSettings settings = changed();
    settings.panel = false;
    settings.targetFps = 25;
    const Json json = Json::parse(toJson(settings).dump()).value();
    expectSame(parsed(withRemembered(json, {"alps"}, true)), settings.engine);
    const EngineOptions mixed =
        parsed(withRemembered(json, {"alps", "--tolerance", "3", "--sun-time=2026-06-21T12:00Z"}, true));
    EXPECT_EQ(mixed.selection.tolerance, Pixels(3));
    EXPECT_TRUE(mixed.sunTime.has_value());
    EXPECT_EQ(mixed.exaggeration, 1.23);
    ViewOptions options;
    ASSERT_TRUE(options.parse(withRemembered(json, {"alps"}, true)));
    EXPECT_EQ(options.targetFps, 25);
    ViewSettings restored;
    restorePanels(json, restored);
    EXPECT_FALSE(restored.panel);
    EXPECT_TRUE(restored.instruments);
}

TEST(ViewerSettings, PicturesHaveTheWindowsShapeAndAtMost16384PixelsASide) {
    const glm::ivec2 window(1200, 800);
    EXPECT_EQ(pictureSize(PictureSize::window, window), window);
    EXPECT_EQ(pictureSize(PictureSize::twice, window), glm::ivec2(2400, 1600));
    EXPECT_EQ(pictureSize(PictureSize::fourTimes, window), glm::ivec2(4800, 3200));
    EXPECT_EQ(pictureSize(PictureSize::wide, window), glm::ivec2(16384, 10923));
    EXPECT_EQ(pictureSize(PictureSize::fourTimes, {5120, 2880}), glm::ivec2(16384, 9216));
    EXPECT_EQ(pictureSize(PictureSize::twice, {30000, 1}), glm::ivec2(30000, 1)) << "a window that is larger";
    EXPECT_EQ(pictureSize(PictureSize::wide, {1, 16384}), glm::ivec2(1, 16384));

    ViewSettings settings, restored;
    settings.pictureSize = PictureSize::wide;
    restorePanels(toJson(settings), restored);
    EXPECT_EQ(restored.pictureSize, PictureSize::wide);
    restorePanels(Json::parse(R"({"picture_size": 4})").value(), restored);
    restorePanels(Json::parse(R"({"picture_size": -1})").value(), restored);
    EXPECT_EQ(restored.pictureSize, PictureSize::wide) << "nonsense is left out";
}

TEST(ViewerSettings, OfNonsenseNothingIsRemembered) {
    for (const char* text : {"null", "[]", R"({"options": 3})", R"({"options": {"out": "a.png", "tolerance": 3}})"}) {
        const Json json = Json::parse(text).value();
        EXPECT_EQ(withRemembered(json, {"alps"}, true), Arguments{"alps"}) << text;
    }
}

TEST(ViewerSettings, AnHourIsRememberedOnlyWhereItMeansSomething) {
    const Json json = Json::parse(R"({"options": {"sun-time": "2026-06-21T12:00Z"}})").value();
    EXPECT_EQ(withRemembered(json, {"alps"}, false), Arguments{"alps"});
    EXPECT_EQ(withRemembered(json, {"alps"}, true).size(), 2u);
}

TEST(ViewerSettings, TheThirtyFirstOfAShortMonthIsItsLastDay) {
    const SunSetting sun{.year = 2023, .month = 2, .day = 31, .minute = 61};
    EXPECT_EQ(sun.time(), *parseUtcTime("2023-02-28T01:01Z"));
}

TEST(ViewerSettings, LieInTheFolderThatTheEnvironmentNames) {
    setenv("XDG_CONFIG_HOME", "/somewhere", 1);
    EXPECT_EQ(configFolder(), std::filesystem::path("/somewhere/terray"));
    unsetenv("XDG_CONFIG_HOME");
    setenv("HOME", "/home/me", 1);
    EXPECT_EQ(configFolder(), std::filesystem::path("/home/me/.config/terray"));
    unsetenv("HOME");
    EXPECT_EQ(configFolder(), std::nullopt);
}

TEST(Readout, TellsSlopeAndPlace) {
    class Incline final : public Ground {
        std::optional<GroundHeight> under(glm::dvec2 place) override {
            if (place.x < 0) return {};
            return GroundHeight{place.x + 10, 0};
        }
    } incline;
    EXPECT_NEAR(degreesFromRadians(slopeAt(incline, {100, 0}, Metres(5)).value()), 45, 1e-9);
    EXPECT_FALSE(slopeAt(incline, {2, 0}, Metres(5)).has_value());
    EXPECT_EQ(describePlace({1.25, -3, 100}, nullptr), "x 1.2, y -3.0\nheight 100.0 m");
}

TEST(Readout, LengthsAreRound) {
    EXPECT_EQ(scaleBarLength(Metres(199)), Metres(100));
    EXPECT_EQ(scaleBarLength(Metres(2000)), Metres(2000));
    EXPECT_EQ(scaleBarLength(Metres(0.7)), Metres(0.5));
    EXPECT_EQ(lengthText(Metres(1.234)), "1.23 m");
    EXPECT_EQ(lengthText(Metres(350.2)), "350 m");
    EXPECT_EQ(lengthText(Metres(12345)), "12.35 km");
    EXPECT_EQ(bytesText(512), "512 B");
    EXPECT_EQ(bytesText(1.5 * 1024 * 1024), "1.5 MB");
}

TEST(FrameHistory, HasPercentilesAndARate) {
    FrameHistory history;
    EXPECT_EQ(history.percentileMs(50), 0);
    for (int n = 1; n <= 300; ++n) history.add(n, n * 0.1, static_cast<uint64_t>(n) * 1000);
    EXPECT_EQ(history.milliseconds().size(), FrameHistory::kFrames);
    EXPECT_EQ(history.milliseconds().front(), 61);
    EXPECT_EQ(history.percentileMs(50), 180);
    EXPECT_EQ(history.percentileMs(99), 298);
    EXPECT_NEAR(history.bytesPerSecond(30), 10000, 500);
    EXPECT_EQ(history.bytesPerSecond(100), 0);
}

}  // namespace
}  // namespace terray::test
