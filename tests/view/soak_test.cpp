// Random input for as long as TERRAY_SOAK_SECONDS says (10): tests/bench/soak_viewer runs it for ten minutes.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <unistd.h>

#include "client/render/gl_context.h"
#include "client/view/viewer.h"
#include "tests/common/random.h"
#include "tests/common/temporary_directory.h"
#include "tests/support/analytic_dataset.h"
#include "tests/support/virtual_display.h"

namespace terray {
namespace {

using Kind = WindowEvent::Kind;
using test::Random;

double residentMegabytes() {
    std::ifstream file("/proc/self/statm");
    double pages = 0;
    file >> pages >> pages;
    return pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

/// A hand that does anything but quit, and writes few files.
class Hand {
  public:
    Hand(Viewer& viewer, uint64_t seed) : viewer_(viewer), random_(seed) {}

    void act() {
        switch (random_.below(14)) {
            case 0:
            case 1:
            case 2:
                send({.kind = Kind::keyDown, .key = held()});
                break;
            case 3:
            case 4:
                send({.kind = Kind::keyUp, .key = held()});
                break;
            case 5:
                send({.kind = Kind::buttonDown, .button = button()});
                break;
            case 6:
                send({.kind = Kind::buttonUp, .button = button()});
                break;
            case 7:
                send({.kind = Kind::wheel, .wheel = random_.between(-3, 3)});
                break;
            case 8:
                doubleClick();
                break;
            case 9:
                send({.kind = Kind::keyDown, .key = command(), .control = false});
                break;
            case 10:
                if (random_.below(20) == 0) viewer_.window().setSize(size(), size());
                break;
            case 11:
                if (random_.below(10) == 0) send({.kind = Kind::focusLost});
                break;
            default:
                send({.kind = Kind::cursor, .cursor = {random_.between(-50, 400), random_.between(-50, 400)}});
        }
    }

  private:
    void send(const WindowEvent& event) { viewer_.window().inject(event); }
    void doubleClick() {
        for (int n = 0; n < 2; ++n) {
            send({.kind = Kind::buttonDown});
            send({.kind = Kind::buttonUp});
        }
    }
    int size() { return 120 + static_cast<int>(random_.below(240)); }
    MouseButton button() { return static_cast<MouseButton>(random_.below(3)); }
    Key held() { return letter("WASDEQ"[random_.below(6)]); }
    Key command() {
        static constexpr Key kKeys[] = {Key::f1,     Key::f2,     Key::f3,     Key::f4,     Key::f5,
                                        Key::home,   Key::escape, letter('H'), letter('O'), letter('F'),
                                        letter('T'), letter('N'), letter('G'), letter('1'), letter('2'),
                                        letter('1'), letter('2'), letter('L'), letter('C'), letter('K'),
                                        Key::insert, Key::enter,  Key::remove, Key::comma,  Key::period};
        return kKeys[random_.below(std::size(kKeys))];
    }

    Viewer& viewer_;
    Random random_;
};

bool finite(const Camera& camera) {
    const glm::dvec3& place = camera.position;
    return std::isfinite(place.x + place.y + place.z + camera.heading.value() + camera.pitch.value());
}

/// Whether a ray must meet the ground within the dataset: it starts above it and is clearly below it before it leaves.
bool mustMeetGround(const View& view, const glm::dvec3& ray, const GroundRect& ground) {
    const double step = 40 / glm::length(glm::dvec3(ray.x, ray.y, ray.z / 2));
    for (double t = step; t < 20000; t += step) {
        const glm::dvec3 place = view.eye + t * ray;
        if (place.x < ground.west || place.x > ground.east || place.y < ground.south || place.y > ground.north)
            return false;
        // Coarse stand-ins may lie lower by what their cells span.
        if (place.z < AnalyticDataset::heightAt(place.x, place.y) - 150) return true;
    }
    return false;
}

TEST(SoakedViewer, KeepsAboveTheGroundAndShowsItWithoutHolesErrorsOrLeaks) {
    const char* const told = std::getenv("TERRAY_SOAK_SECONDS");
    const double seconds = told == nullptr ? 10 : std::atof(told);
    const VirtualDisplay display;
    const test::TemporaryDirectory folder;
    const AnalyticDataset dataset({.finestLevel = 3, .imageryLevel = 3});
    const GroundRect ground = dataset.metadata().groundBounds();
    const ShaderLibrary shaders;
    ViewerOptions options;
    options.window = {.width = 320, .height = 240, .vsync = false, .debug = true};
    options.engine.render.launch = Launch::raster;
    options.engine.pager.hostBudgetBytes = 48ull << 20;
    options.engine.gpuHeightBytes = options.engine.gpuImageryBytes = 24ull << 20;
    options.pictures = folder.path();
    options.camera = Camera{.position = {404000, 5192000, 1800}, .pitch = radiansFromDegrees(-30)};
    Viewer viewer(dataset, shaders, options);
    std::string messages;
    collectDebugMessages(messages);

    for (const char digit : {'1', '2'}) {  // ways back from afar
        viewer.window().inject({.kind = Kind::keyDown, .key = letter(digit), .control = true});
        viewer.turnFor(0.01);
    }
    Hand hand(viewer, 1);
    Random random(2);
    const auto start = std::chrono::steady_clock::now();
    const auto elapsed = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    int frames = 0, probes = 0;
    double halfway = 0, lowest = 1e9;
    while (elapsed() < seconds) {
        for (uint64_t n = random.below(4); n > 0; --n) hand.act();
        if (!viewer.turn(0.005)) continue;
        ++frames;
        if (halfway == 0 && elapsed() > seconds / 2) halfway = residentMegabytes();
        const Camera& camera = viewer.navigator().camera();
        ASSERT_TRUE(finite(camera)) << frames;
        const glm::dvec3& eye = camera.position;
        const bool inside = eye.x > ground.west && eye.x < ground.east && eye.y > ground.south && eye.y < ground.north;
        if (inside) lowest = std::min(lowest, eye.z - AnalyticDataset::heightAt(eye.x, eye.y));
        ASSERT_GT(lowest, 1.2) << "metres over ground, less what 4 m samples leave out";
        if (!inside || frames % 8 != 0) continue;
        const View& view = viewer.engine().view();
        const bool frozen = viewer.frozen();  // then nodes outside the old picture are missing on purpose
        for (int n = 0; n < 8 && !frozen; ++n) {
            const auto column = static_cast<int>(random.below(static_cast<uint64_t>(view.width)));
            const auto row = static_cast<int>(random.below(static_cast<uint64_t>(view.height)));
            if (!mustMeetGround(view, view.direction(column + 0.5, row + 0.5), ground)) continue;
            ++probes;
            ASSERT_TRUE(viewer.engine().placeAt(column, row).has_value()) << "a hole in frame " << frames;
        }
    }
    const double end = residentMegabytes();
    std::printf("%d frames, %d probes, lowest %.2f m over ground, resident %.1f MB half way, %.1f MB at the end\n",
                frames, probes, lowest, halfway, end);
    EXPECT_EQ(messages, "") << "of the driver";
    EXPECT_GT(frames, 20);
    EXPECT_GT(probes, 10);
#ifndef __SANITIZE_ADDRESS__  // which keeps freed memory back
    EXPECT_LT(end - halfway, 24) << "megabytes";
#endif
}

}  // namespace
}  // namespace terray
