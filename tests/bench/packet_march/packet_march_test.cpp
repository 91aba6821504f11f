// The packet march against brute force and against the scalar march, with every kernel that this machine runs.

#include "tests/bench/packet_march/packet_march.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/bench/packet_march/brute_force.h"
#include "tests/bench/packet_march/scalar_march.h"
#include "tests/bench/packet_march/test_maps.h"

namespace terray::test {
namespace {

std::vector<const PacketKernel*> kernels() {
    std::vector<const PacketKernel*> found{&portableKernel()};
    if (avx2Kernel() != nullptr) found.push_back(avx2Kernel());
    return found;
}

std::vector<float> cast(const PacketKernel& kernel, const HeightPyramid& pyramid, const std::vector<MapRay>& rays) {
    std::vector<float> t(rays.size(), -1);
    castRays(kernel, pyramid, rays, t);
    return t;
}

struct Picture {
    Grid<float> depths;
    CastWork work;
};

Picture castPicture(const PacketKernel& kernel, const HeightPyramid& pyramid, const View& view, bool beams) {
    const PictureRays rays = pictureRays(view, kMapFrame);
    Picture picture{Grid<float>({view.width, view.height}, -1), {}};
    for (int tile = 0; tile < tileCount(rays); ++tile)
        picture.work += castPictureTile(kernel, pyramid, rays, tile, beams, picture.depths.view());
    return picture;
}

TEST(HeightPyramid, HoldsTheGreatestSampleThatAnyPatchOfABlockInterpolates) {
    for (const TestMap& map : testMaps()) {
        const HeightPyramid pyramid(map.codes.view());
        for (int level = 1; level <= pyramid.view().coarsest; ++level) {
            const auto blocks = pyramid.maxima(level);
            for (int64_t y = 0; y < blocks.height(); ++y)
                for (int64_t x = 0; x < blocks.width(); ++x) {
                    const GridRect patches = intersection({x << level, y << level, 1LL << level, 1LL << level},
                                                          {0, 0, map.codes.width() - 1, map.codes.height() - 1});
                    uint16_t greatest = 0;
                    for (int64_t row = patches.y; row <= patches.y + patches.height && !patches.empty(); ++row)
                        for (int64_t column = patches.x; column <= patches.x + patches.width; ++column)
                            greatest = std::max(greatest, map.codes.at(column, row));
                    ASSERT_EQ(blocks.at(x, y), greatest) << map.name << " level " << level << ": " << x << ", " << y;
                }
        }
    }
}

TEST(HeightPyramid, KnowsTheGreatestOfTheBlocksAroundEach) {
    for (const TestMap& map : testMaps()) {
        const HeightPyramid pyramid(map.codes.view());
        for (int level = 1; level <= pyramid.view().coarsest; ++level) {
            const auto blocks = pyramid.maxima(level);
            for (int64_t y = 0; y < blocks.height(); ++y)
                for (int64_t x = 0; x < blocks.width(); ++x) {
                    uint16_t greatest = 0;
                    for (int64_t i = 0; i < 9; ++i)
                        greatest = std::max(greatest, blocks.clamped(x + i % 3 - 1, y + i / 3 - 1));
                    ASSERT_EQ(pyramid.around(level).at(x, y), greatest) << map.name << " level " << level;
                }
        }
    }
}

TEST(ScalarMarch, FindsTheFirstContactOfRandomAndSpecialRays) {
    for (const TestMap& map : testMaps()) {
        const HeightPyramid pyramid(map.codes.view());
        for (const MapRay& ray : randomRays(map, 1000, 1)) expectFirstContact(map, ray, scalarMarch(pyramid, ray).t);
        for (const MapRay& ray : specialRays(map)) expectFirstContact(map, ray, scalarMarch(pyramid, ray).t);
    }
}

TEST(PacketMarch, FindsTheFirstContactOfRandomRays) {
    for (const PacketKernel* kernel : kernels()) {
        SCOPED_TRACE(kernel->name);
        for (const TestMap& map : testMaps()) {
            const auto rays = randomRays(map, 2003, 2);  // the last packet is not full
            const auto t = cast(*kernel, HeightPyramid(map.codes.view()), rays);
            for (size_t i = 0; i < rays.size(); ++i) expectFirstContact(map, rays[i], t[i]);
            const auto hits = static_cast<size_t>(std::ranges::count_if(t, [](float d) { return std::isfinite(d); }));
            EXPECT_GT(hits, rays.size() / 4) << map.name;
            EXPECT_LT(hits, rays.size() - rays.size() / 8) << map.name;
        }
    }
}

TEST(PacketMarch, FindsTheFirstContactAlongAxesAndThroughCorners) {
    for (const PacketKernel* kernel : kernels()) {
        SCOPED_TRACE(kernel->name);
        for (const TestMap& map : testMaps()) {
            const auto rays = specialRays(map);
            const auto t = cast(*kernel, HeightPyramid(map.codes.view()), rays);
            for (size_t i = 0; i < rays.size(); ++i) expectFirstContact(map, rays[i], t[i]);
        }
    }
}

TEST(PacketMarch, AgreesWithTheScalarMarchButForRounding) {
    for (const PacketKernel* kernel : kernels()) {
        SCOPED_TRACE(kernel->name);
        const TestMap map = testMaps().front();
        const HeightPyramid pyramid(map.codes.view());
        const auto rays = randomRays(map, 8000, 3);
        const auto t = cast(*kernel, pyramid, rays);
        int differ = 0;  // a ray that touches a crest passes it in the other precision
        for (size_t i = 0; i < rays.size(); ++i) {
            const double exact = scalarMarch(pyramid, rays[i]).t;
            if (t[i] != exact && !(std::abs(t[i] - exact) <= 2e-3 * (1 + exact))) ++differ;
        }
        EXPECT_LE(differ, 8);
    }
}

TEST(PacketMarch, HitsWhatARayEntersFromTheSideOrStartsIn) {
    const TestMap plateau = testMaps()[3];  // 17 x 17 samples of 100
    for (const PacketKernel* kernel : kernels()) {
        const std::vector<MapRay> rays{{{-5, 8, 50}, {1, 0, 0}},      // into the side
                                       {{8, 21, 50}, {0, -2, 1}},     // likewise, mirrored and rising
                                       {{8, 8, 50}, {0, 0, 1}},       // from within
                                       {{8, 8, 100}, {0, 0, 1}},      // from the surface: solid ground includes it
                                       {{8, 8, 101}, {0, 0, 1}},      // away
                                       {{-5, 8, 100.5F}, {1, 0, 0}},  // over it
                                       {{-5, 8, 50}, {-1, 0, 0}}};    // away from the map
        const float none = std::numeric_limits<float>::infinity();
        EXPECT_EQ(cast(*kernel, HeightPyramid(plateau.codes.view()), rays),
                  (std::vector<float>{5, 2.5F, 0, 0, none, none, none}))
            << kernel->name;
    }
}

struct NamedView {
    const char* name;
    View view;
};

std::vector<NamedView> views(const TestMap& map) {
    const double quarter = std::numbers::pi / 2;
    return {{"straight down", viewOf(map, {0.5, 0.5, 2}, 0, -quarter)},
            {"down a shaft", viewOf(map, {0.51, 0.51, 1.02}, 0.2, -quarter)},
            {"down from afar, the map small", viewOf(map, {0.4, 0.6, 20}, 0.3, -quarter)},
            {"along a row", viewOf(map, {-0.1, 0.5, 1.05}, quarter, -0.1)},
            {"along a diagonal, from outside", viewOf(map, {1.3, 1.2, 1.5}, -quarter / 2, -0.3)},
            {"horizon, from within", viewOf(map, {0.2, 0.2, 0.9}, 2.4, 0)},
            {"beside the map", viewOf(map, {-0.4, 0.5, 0.5}, 0.25, -0.1)},
            {"away from the map", viewOf(map, {-0.4, 0.5, 0.5}, -quarter, 0)},
            {"upwards", viewOf(map, {0.5, 0.5, 0.6}, 1, 0.7)}};
}

TEST(PacketMarch, FindsTheFirstContactOfEveryPixelWithBeamsAndWithout) {
    const std::vector<TestMap> maps = testMaps();
    for (const PacketKernel* kernel : kernels())
        for (const TestMap* map : {&maps[0], &maps[1], &maps[4], &maps[5]}) {
            const HeightPyramid pyramid(map->codes.view());
            for (const auto& [name, view] : views(*map))
                for (const bool beams : {false, true}) {
                    SCOPED_TRACE(std::string(kernel->name) + ", " + name + (beams ? ", beams" : ""));
                    const PictureRays rays = pictureRays(view, kMapFrame);
                    const Picture picture = castPicture(*kernel, pyramid, view, beams);
                    for (int y = 0; y < view.height; y += 3)
                        for (int x = y % 2; x < view.width; x += 2)
                            expectFirstContact(*map, pixelRay(rays, x, y), picture.depths.at(x, y));
                }
        }
}

TEST(PacketMarch, TakesAsManyStepsAsTheScalarMarch) {
    const TestMap map = testMaps().front();
    const HeightPyramid pyramid(map.codes.view());
    for (const PacketKernel* kernel : kernels()) {
        int64_t packetSteps = 0;
        int64_t scalarSteps = 0;
        for (const MapRay& ray : randomRays(map, 500, 4)) {
            // A tile of one ray, many times over: its packets are all alike.
            const PictureRays rays{ray.eye, ray.direction, {}, {}, kTileWidth, kTileHeight};
            Grid<float> depths({kTileWidth, kTileHeight});
            const CastWork work = castPictureTile(*kernel, pyramid, rays, 0, false, depths.view());
            packetSteps += 8 * (work.pyramidSteps + work.patchSteps);
            scalarSteps += scalarMarch(pyramid, ray).steps * depths.size().count();
        }
        EXPECT_NEAR(static_cast<double>(packetSteps) / static_cast<double>(scalarSteps), 1, 0.01) << kernel->name;
    }
}

TEST(PacketMarch, BeamsSpareAThirdOfTheStepsOnASmallMap) {
    const TestMap map = testMaps().front();
    const HeightPyramid pyramid(map.codes.view());
    for (const PacketKernel* kernel : kernels()) {
        View view = viewOf(map, {0.1, 0.1, 1.2}, 2.4, -0.2);
        view.width = 640;
        view.height = 360;
        const CastWork with = castPicture(*kernel, pyramid, view, true).work;
        const CastWork without = castPicture(*kernel, pyramid, view, false).work;
        EXPECT_GT(with.beamSteps, 0);
        EXPECT_LT(3 * (with.beamSteps + with.pyramidSteps), 2 * without.pyramidSteps) << kernel->name;
    }
}

}  // namespace
}  // namespace terray::test
