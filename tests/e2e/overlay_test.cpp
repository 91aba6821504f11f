// Triangles in the picture of a terrain: each pixel shows whatever of ground and overlay is nearer, as computed by
// closed forms in double.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "client/overlay/shapes.h"
#include "common/error.h"
#include "tests/common/temporary_directory.h"
#include "tests/e2e/scene.h"

namespace terray {
namespace {

constexpr int kWidth = 240;
constexpr int kHeight = 160;
constexpr double kNever = 1e300;

/// Depths at which a ray enters and leaves a box; enter > leave if it misses.
struct Span {
    double enter = -kNever;
    double leave = kNever;
};

Span boxSpan(const glm::dvec3& eye, const glm::dvec3& direction, const glm::dvec3& low, const glm::dvec3& high) {
    Span span;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (low[axis] - eye[axis]) / direction[axis];
        const double b = (high[axis] - eye[axis]) / direction[axis];
        span.enter = std::max(span.enter, std::min(a, b));
        span.leave = std::min(span.leave, std::max(a, b));
    }
    return span;
}

double boxDepth(const glm::dvec3& eye, const glm::dvec3& direction, const glm::dvec3& low, const glm::dvec3& high) {
    const Span span = boxSpan(eye, direction, low, high);
    return span.enter <= span.leave && span.enter > 0 ? span.enter : kNever;
}

/// Distance between a line of sight and a segment, by search over the segment (convex in its parameter).
double distanceToSegment(const glm::dvec3& eye, const glm::dvec3& direction, const glm::dvec3& from,
                         const glm::dvec3& to) {
    const glm::dvec3 unit = glm::normalize(direction);
    const auto away = [&](double share) {
        const glm::dvec3 place = glm::mix(from, to, share) - eye;
        return glm::length(place - std::max(0.0, glm::dot(place, unit)) * unit);
    };
    double low = 0;
    double high = 1;
    for (int i = 0; i < 100; ++i) {
        const double third = (high - low) / 3;
        (away(low + third) < away(high - third) ? high : low) +=
            away(low + third) < away(high - third) ? -third : third;
    }
    return away(low);
}

/// Which overlay a pixel shows. Things in these tests are pure red or pure blue, ground and sky neither. Either: the
/// closed form does not tell.
enum class Shown { terrain, red, blue, either };

std::ostream& operator<<(std::ostream& out, Shown shown) {
    return out << (shown == Shown::terrain ? "terrain" : shown == Shown::red ? "red" : "blue");
}

Shown shownBy(const std::array<uint8_t, 4>& colour) {
    if (colour[0] > 20 && colour[1] < 2 && colour[2] < 2) return Shown::red;
    if (colour[2] > 20 && colour[0] < 2 && colour[1] < 2) return Shown::blue;
    return Shown::terrain;
}

constexpr glm::vec3 kRed(1, 0, 0);
constexpr glm::vec3 kBlue(0, 0, 1);

class OverlayTest : public testing::Test {
  protected:
    HeadlessContext context_{HeadlessContext::Options{.debug = true}};
    ShaderLibrary shaders_;
    void TearDown() override { EXPECT_EQ(context_.takeDebugMessages(), ""); }

    std::unique_ptr<Engine> engineWith(const TileSource& source, std::vector<OverlayMesh> overlay,
                                       Launch launch = Launch::raster) {
        EngineOptions options;
        options.render.surface = Surface::columns;
        options.render.launch = launch;
        options.render.sunDirection = {0, -1, 0};  // from behind most cameras: undersides are not black
        options.overlay = std::move(overlay);
        return std::make_unique<Engine>(source, shaders_, options, kWidth, kHeight);
    }

    /// Compares each pixel with what `expected(eye, direction)` says, but for those where it says different things a
    /// fiftieth of a pixel to either side. Returns the pixels that show red or blue.
    template <class Expected>
    int64_t expectPixels(const Engine& engine, const Expected& expected) {
        const auto colours = engine.targets().readSrgb();
        const View& view = engine.view();
        int64_t drawn = 0;
        int64_t undecided = 0;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const auto at = [&](double dx, double dy) {
                    return expected(view.eye, view.direction(x + 0.5 + dx, y + 0.5 + dy));
                };
                const Shown centre = at(0, 0);
                constexpr double kAway = 0.02;
                if (centre == Shown::either || at(kAway, 0) != centre || at(-kAway, 0) != centre ||
                    at(0, kAway) != centre || at(0, -kAway) != centre) {
                    ++undecided;
                    continue;
                }
                EXPECT_EQ(shownBy(colours.at(x, y)), centre) << x << ' ' << y;
                drawn += centre == Shown::terrain ? 0 : 1;
            }
        EXPECT_LT(undecided, kWidth * kHeight / 50);
        return drawn;
    }
};

/// Flat ground at 100 m and across it, from west to east, a wall 40 m thick and 150 m high.
class WallScene {
  public:
    static constexpr double kGround = 100;
    static constexpr double kTop = 250;
    static constexpr double kSouth = 5000 - 620;  // the wall's faces
    static constexpr double kNorth = 5000 - 580;

    WallScene()
        : dataset_([](int64_t, int64_t row) { return float(row >= 580 && row < 620 ? kTop : kGround); }, {1200, 1200},
                   1) {}
    [[nodiscard]] const TileSource& source() const { return dataset_.source(); }

    [[nodiscard]] static double depth(const glm::dvec3& eye, const glm::dvec3& direction) {
        const glm::dvec3 low(-1e5, kSouth, -1e5);
        const double wall = boxDepth(eye, direction, low, {1e5, kNorth, kTop});
        const double ground = direction.z < 0 ? (kGround - eye.z) / direction.z : kNever;
        return std::min(wall, ground);
    }

  private:
    ComputedDataset dataset_;
};

/// A cube as its base's centre and its side.
struct Cube {
    glm::dvec3 base;
    double side;
    [[nodiscard]] double depth(const glm::dvec3& eye, const glm::dvec3& direction) const {
        const glm::dvec3 half(side / 2, side / 2, 0);
        return boxDepth(eye, direction, base - half, base + half + glm::dvec3(0, 0, side));
    }
};

TEST_F(OverlayTest, CubesBehindInAndBeforeAWallShowWhatIsNearerInEachPixel) {
    const WallScene scene;
    const Cube behind = {{1500, WallScene::kNorth + 100, 130}, 160};  // looks over the wall
    const Cube within = {{1680, WallScene::kSouth, 80}, 120};         // sticks out of wall and ground
    const auto expected = [&](const glm::dvec3& eye, const glm::dvec3& direction) {
        const double red = behind.depth(eye, direction);
        const double blue = within.depth(eye, direction);
        const double nearest = std::min(red, blue);
        if (nearest >= WallScene::depth(eye, direction)) return Shown::terrain;
        return red < blue ? Shown::red : Shown::blue;
    };
    const std::vector<OverlayMesh> meshes = {cubeMesh(behind.base, behind.side, kRed),
                                             cubeMesh(within.base, within.side, kBlue)};
    for (const Launch launch : {Launch::raster, Launch::compute}) {
        const auto engine = engineWith(scene.source(), meshes, launch);
        // Over the wall, along it from a side on which one cube hides the other, and from behind.
        for (const Camera& camera : {cameraAt({1560, 3900, 320}, 0, -6), cameraAt({1900, 4150, 400}, -40, -15),
                                     cameraAt({1350, 4800, 300}, 150, -8)}) {
            engine->drawFrame(camera, true);
            EXPECT_GT(expectPixels(*engine, expected), 300);
        }
    }
}

TEST_F(OverlayTest, CubesHideOneAnotherInWhateverOrderTheyAreDrawn) {
    const WallScene scene;
    const Cube near = {{1500, 4100, 100}, 60};
    const Cube far = {{1520, 4180, 100}, 90};
    const auto expected = [&](const glm::dvec3& eye, const glm::dvec3& direction) {
        const double red = near.depth(eye, direction);
        const double blue = far.depth(eye, direction);
        if (std::min(red, blue) >= WallScene::depth(eye, direction)) return Shown::terrain;
        return red < blue ? Shown::red : Shown::blue;
    };
    std::vector<OverlayMesh> meshes = {cubeMesh(near.base, near.side, kRed), cubeMesh(far.base, far.side, kBlue)};
    for (int order = 0; order < 2; ++order) {
        const auto engine = engineWith(scene.source(), meshes);
        engine->drawFrame(cameraAt({1500, 3800, 180}, 2, -5), true);
        EXPECT_GT(expectPixels(*engine, expected), 1000);
        std::swap(meshes[0], meshes[1]);
    }
}

TEST_F(OverlayTest, AgainstTheSkyIsHiddenByNothing) {
    const WallScene scene;
    const Cube high = {{1500, 4300, 600}, 80};
    const auto engine = engineWith(scene.source(), {cubeMesh(high.base, high.side, kRed)});
    engine->drawFrame(cameraAt({1480, 3900, 640}, 2, 2), true);
    EXPECT_GT(expectPixels(*engine,
                           [&](const glm::dvec3& eye, const glm::dvec3& direction) {
                               return high.depth(eye, direction) < kNever ? Shown::red : Shown::terrain;
                           }),
              1000);
}

TEST_F(OverlayTest, ATrackAboveTheGroundIsSeenAndOneBelowIsNot) {
    const ComputedDataset plane([](int64_t, int64_t) { return 100.0f; }, {1024, 1024}, 1);
    const double radius = 2;
    const auto at = [&](double z) {
        return std::vector<std::vector<glm::dvec3>>{{{1300, 4300, z}, {1500, 4400, z}, {1500, 4600, z}}};
    };
    const auto tube = [&](double z) { return tubeMesh(at(z), {.radius = radius, .sides = 64, .colour = kRed}); };
    const Camera camera = cameraAt({1450, 4250, 160}, 0, -20);

    const auto above = engineWith(plane.source(), {tube(100 + radius + 0.1)});
    above->drawFrame(camera, true);
    const std::vector<glm::dvec3> line = at(100 + radius + 0.1)[0];
    const auto expected = [&](const glm::dvec3& eye, const glm::dvec3& direction) {
        const double away = std::min(distanceToSegment(eye, direction, line[0], line[1]),
                                     distanceToSegment(eye, direction, line[1], line[2]));
        return away < radius ? Shown::red : Shown::terrain;
    };
    EXPECT_GT(expectPixels(*above, expected), 300);

    const auto below = engineWith(plane.source(), {tube(100 - radius - 0.1)});
    below->drawFrame(camera, true);
    EXPECT_EQ(expectPixels(*below, [](const auto&, const auto&) { return Shown::terrain; }), 0);
}

TEST_F(OverlayTest, ThingsWithALeastSizeStayVisibleFromAfar) {
    const ComputedDataset plane([](int64_t, int64_t) { return 100.0f; }, {1024, 1024}, 10);
    OverlayMesh pin = pinMesh({6000, 4000, 100}, 2, kRed);
    pin.leastPixels = 20;
    const OverlayMesh tube = tubeMesh(std::vector<std::vector<glm::dvec3>>{{{2000, 1500, 300}, {10000, 1500, 300}}},
                                      {.radius = 0.5, .leastPixels = 2, .colour = kBlue});
    const auto engine = engineWith(plane.source(), {pin, tube});
    for (const double south : {-1000.0, -4000.0}) {
        engine->drawFrame(cameraAt({6000, south, 900}, 0, -8, 30), true);
        const auto colours = engine->targets().readSrgb();
        int pinRows = 0;
        for (int y = 0; y < kHeight; ++y) {
            bool red = false;
            for (int x = 0; x < kWidth; ++x) red |= shownBy(colours.at(x, y)) == Shown::red;
            pinRows += red ? 1 : 0;
        }
        EXPECT_LE(pinRows, 21);
        EXPECT_GE(pinRows, 17) << "the lowest two are narrower than a pixel";
        // 4 pixels thick wherever it is drawn, its ends' balls apart.
        for (int x = kWidth / 2 - 20; x < kWidth / 2 + 20; x += 5) {
            int rows = 0;
            for (int y = 0; y < kHeight; ++y) rows += shownBy(colours.at(x, y)) == Shown::blue ? 1 : 0;
            EXPECT_NEAR(rows, 4, 1) << x;
        }
    }
}

TEST_F(OverlayTest, IsExaggeratedInItsPlaceButNotInItsShape) {
    const WallScene scene;
    const double factor = 2;
    const glm::dvec3 base(1500, 4200, 130);
    // Two balls of one mesh, so that it is anchors that are exaggerated. Their facets lie within 0.96 of the radius.
    const std::vector<std::vector<glm::dvec3>> balls = {{{1420, 4200, 120}}, {{1450, 4250, 165}}};
    const auto stretched = [&](glm::dvec3 place) { return glm::dvec3(place.x, place.y, factor * place.z); };
    const auto engine = engineWith(
        scene.source(), {cubeMesh(base, 60, kRed), tubeMesh(balls, {.radius = 15, .sides = 64, .colour = kBlue})});
    engine->setExaggeration(factor);
    engine->drawFrame(cameraAt({1480, 3900, 170}, 0, -5), true);
    EXPECT_GT(expectPixels(*engine,
                           [&](const glm::dvec3& eye, const glm::dvec3& direction) {
                               if (Cube{stretched(base), 60}.depth(eye, direction) < kNever) return Shown::red;
                               const auto away = [&](const glm::dvec3& place) {
                                   return distanceToSegment(eye, direction, stretched(place), stretched(place));
                               };
                               const double nearest = std::min(away(balls[0][0]), away(balls[1][0]));
                               if (nearest > 0.96 * 15 && nearest < 15) return Shown::either;
                               return nearest < 15 ? Shown::blue : Shown::terrain;
                           }),
              500);
}

/// Depth at which a bent ray z(t) = height + t slope + t^2 bend first has a height from low to high, within a span.
double bentDepth(double height, double slope, double bend, const Span& span, double low, double high) {
    const double start = std::max(span.enter, 0.0);
    if (span.leave < start) return kNever;
    std::vector<double> candidates = {start};
    for (const double level : {low, high}) {
        const double discriminant = slope * slope - 4 * bend * (height - level);
        if (discriminant < 0) continue;
        candidates.push_back((-slope - std::sqrt(discriminant)) / (2 * bend));
        candidates.push_back((-slope + std::sqrt(discriminant)) / (2 * bend));
    }
    std::ranges::sort(candidates);
    for (const double t : candidates) {
        const double z = height + t * (slope + t * bend);
        if (t >= start && t <= span.leave && z >= low - 1e-6 && z <= high + 1e-6) return t;
    }
    return kNever;
}

TEST_F(OverlayTest, OverACurvedEarthLiesWhereTheGroundIs) {
    const WallScene scene;
    const Cube behind = {{1500, WallScene::kNorth + 100, 130}, 160};
    const Cube before = {{1620, WallScene::kSouth - 60, 100}, 60};
    EngineOptions options;
    options.render.surface = Surface::columns;
    options.render.sunDirection = {0, -1, 0};
    options.earth = {.shape = EarthShape::curved, .refraction = -1000};  // an earth of 6.4 km radius
    options.overlay = {cubeMesh(behind.base, behind.side, kRed), cubeMesh(before.base, before.side, kBlue)};
    Engine engine(scene.source(), shaders_, options, kWidth, kHeight);
    engine.drawFrame(cameraAt({1560, 3900, 320}, 0, -14), true);
    ASSERT_TRUE(engine.view().earth.has_value());
    EXPECT_GT(engine.view().earth->drop(0, 800), 40);

    const auto expected = [&](const glm::dvec3& eye, const glm::dvec3& direction) {
        const double bend = engine.view().earth->drop(direction.x, direction.y);
        const auto depth = [&](const Span& span, double low, double high) {
            return bentDepth(eye.z, direction.z, bend, span, low, high);
        };
        const auto cube = [&](const Cube& of) {
            const glm::dvec3 half(of.side / 2, of.side / 2, kNever);
            return depth(boxSpan(eye, direction, of.base - half, of.base + half), of.base.z, of.base.z + of.side);
        };
        const double wall =
            depth(boxSpan(eye, direction, {-kNever, WallScene::kSouth, -kNever}, {kNever, WallScene::kNorth, kNever}),
                  -1e9, WallScene::kTop);
        const double ground = std::min(wall, depth({}, -1e9, WallScene::kGround));
        if (std::min(cube(behind), cube(before)) >= ground) return Shown::terrain;
        return cube(behind) < cube(before) ? Shown::red : Shown::blue;
    };
    EXPECT_GT(expectPixels(engine, expected), 1000);
}

TEST_F(OverlayTest, LeavesHitsAndTheRestOfThePictureAlone) {
    const WallScene scene;
    const Camera camera = cameraAt({1560, 3900, 320}, 0, -6);
    const auto bare = engineWith(scene.source(), {});
    bare->drawFrame(camera, true);
    for (const Launch launch : {Launch::raster, Launch::compute}) {
        const auto with = engineWith(scene.source(), {cubeMesh({1500, 4200, 130}, 60, kRed)}, launch);
        with->drawFrame(camera, true);
        EXPECT_TRUE(with->targets().readHits() == bare->targets().readHits());
        EXPECT_TRUE(with->targets().readNodes() == bare->targets().readNodes());
        const auto expected = bare->targets().readSrgb();
        const auto found = with->targets().readSrgb();
        for (size_t i = 0; i < found.cells().size(); ++i)
            EXPECT_TRUE(shownBy(found.cells()[i]) == Shown::red || found.cells()[i] == expected.cells()[i]) << i;
    }
}

TEST_F(OverlayTest, ThatIsNotThereIsNeitherCompiledNorAllocatedNorDrawn) {
    const WallScene scene;
    // A library whose overlay shaders do not compile: whoever compiles them fails.
    const test::TemporaryDirectory folder;
    std::ofstream(folder / "overlay.frag") << "this is no shader\n";
    std::ofstream(folder / "overlay.vert") << "this is no shader\n";
    const ShaderLibrary broken(folder.path());
    EngineOptions options;
    options.render.launch = Launch::raster;
    Engine without(scene.source(), broken, options, kWidth, kHeight);
    const Camera camera = cameraAt({1560, 3900, 320}, 0, -6);
    const FrameReport bare = without.drawFrame(camera, true);
    EXPECT_EQ(bare.gpuMs[static_cast<size_t>(GpuPass::overlay)], 0);

    const OverlayMesh cube = cubeMesh({1500, 4200, 130}, 60, kRed);
    options.overlay = {cube};
    Engine failing(scene.source(), broken, options, kWidth, kHeight);
    EXPECT_THROW((void)failing.drawFrame(camera, true), Error);

    Engine with(scene.source(), shaders_, options, kWidth, kHeight);
    const FrameReport drawn = with.drawFrame(camera, true);
    EXPECT_EQ(drawn.gpuTargets - bare.gpuTargets, kWidth * kHeight * 4u) << "its depth";
    EXPECT_EQ(drawn.gpuBuffers - bare.gpuBuffers,
              cube.vertices.size() * sizeof(OverlayVertex) + cube.indices.size() * sizeof(uint32_t));
}

}  // namespace
}  // namespace terray
