// What each shading mode shows is what its legend says of the pixel's hit, node and steps. Lines:
// shading_lines_test.cpp.

#include <cmath>
#include <map>
#include <set>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "common/height_tile.h"
#include "common/srgb.h"
#include "tests/support/shaded_picture.h"

namespace terray {
namespace {

/// Half floats keep 11 bits, which are half a byte at the bright end; divided by light of the same precision.
constexpr double kByte = 1.0;
constexpr double kTolerance = 0.5;  // pixels

class ShadingTest : public testing::Test {
  protected:
    HeadlessContext context_{HeadlessContext::Options{.debug = true}};
    ShaderLibrary shaders_;
    static inline const AnalyticDataset dataset_{{.finestLevel = 2, .imageryLevel = 2}};  // keeps the tiles it has made
    const Camera camera_ = shadedCamera({403000, 5195000, 2300}, 30, -25);
    void TearDown() override { EXPECT_EQ(context_.takeDebugMessages(), ""); }

    ShadedPicture draw(Shading shading, const EngineOptions& options = {}, int frames = 0) {
        return ShadedPicture(shaders_, dataset_, shading, options, camera_, frames);
    }
    static EngineOptions exaggerated(double factor) {
        EngineOptions options;
        options.exaggeration = factor;
        return options;
    }
    /// So that two levels are in the picture.
    static EngineOptions mixed() {
        EngineOptions options;
        options.selection.tolerance = Pixels(kTolerance);
        return options;
    }
};

/// Greatest distance between what is shown and what is expected, over all ground; fails where there is hardly any.
template <class Shown, class Expected>
double worst(const ShadedPicture& picture, const Shown& shown, const Expected& expected) {
    double greatest = 0;
    int64_t ground = 0;
    for (int64_t y = 0; y < picture.height(); ++y)
        for (int64_t x = 0; x < picture.width(); ++x) {
            if (!picture.isGround(x, y)) continue;
            ++ground;
            greatest = std::max(greatest, distance(shown(x, y), expected(x, y)));
        }
    EXPECT_GT(ground, picture.width() * picture.height() / 3);
    return greatest;
}

template <class Expected>
double worstTint(const ShadedPicture& picture, const Expected& expected) {
    return worst(
        picture, [&](int64_t x, int64_t y) { return picture.tint(x, y); }, expected);
}

template <class Expected>
double worstColour(const ShadedPicture& picture, const Expected& expected) {
    return worst(
        picture, [&](int64_t x, int64_t y) { return picture.colour(x, y); }, expected);
}

/// The Sobel filter of bilinearly filtered codes at a hit, codes per texel. Ground goes on at the hit's height where
/// there is none.
glm::dvec2 sobel(const Grid<uint16_t>& codes, const glm::dvec4& hit) {
    const auto filtered = [&](double x, double y) {
        const double column = std::floor(x), row = std::floor(y), u = x - column, v = y - row;
        const auto code = [&](int dx, int dy) {
            const uint16_t stored = codes.at(static_cast<int>(column) + dx, static_cast<int>(row) + dy);
            return stored == kNoSurface ? hit.z : stored;
        };
        return (code(0, 0) * (1 - u) + code(1, 0) * u) * (1 - v) + (code(0, 1) * (1 - u) + code(1, 1) * u) * v;
    };
    const glm::dvec2 centre = glm::dvec2(hit) - 0.5 + glm::dvec2(kHeightApron);
    glm::dvec2 gradient(0);
    for (const int along : {-1, 0, 1}) {
        const double weight = along == 0 ? 2 : 1;
        gradient.x += weight * (filtered(centre.x + 1, centre.y + along) - filtered(centre.x - 1, centre.y + along));
        gradient.y += weight * (filtered(centre.x + along, centre.y + 1) - filtered(centre.x + along, centre.y - 1));
    }
    return gradient / 8.0;
}

/// Linear colour of an encoded one.
glm::dvec3 linear(const Encoded& encoded) {
    glm::dvec3 out;
    for (int i = 0; i < 3; ++i) out[i] = linearFromSrgb(static_cast<uint8_t>(encoded[i]));
    return out;
}

TEST_F(ShadingTest, LightIsTheGroundWithoutItsPhoto) {
    EngineOptions bare;
    bare.selection.useImagery = false;
    const ShadedPicture light = draw(Shading::light), without = draw(Shading::photo, bare);
    EXPECT_TRUE(light.engine().targets().readLinear() == without.engine().targets().readLinear());
    EXPECT_FALSE(light.engine().targets().features().imagery) << "no photo is paged";
    EXPECT_FALSE(light.engine().targets().readLinear() == draw(Shading::photo).engine().targets().readLinear());
}

TEST_F(ShadingTest, HeightIsAPlaceBetweenTheLowestAndTheHighestWhateverTheExaggeration) {
    constexpr std::array<uint32_t, 7> kStops = {0x5f9168, 0xa0bd7f, 0xdcd59a, 0xd2ae74, 0xb0835a, 0xb9aba3, 0xf7f7f7};
    for (const double factor : {1.0, 2.5}) {
        const ShadedPicture picture = draw(Shading::height, exaggerated(factor));
        EXPECT_LT(worstTint(picture,
                            [&](int64_t x, int64_t y) {
                                return ramp(kStops, 6 * (picture.place(x, y).z - 600) / (1400 - 600));
                            }),
                  kByte)
            << factor;
    }
}

TEST_F(ShadingTest, DepthIsOnItsRampOfHalfDecades) {
    constexpr std::array<uint32_t, 7> kStops = {0xffffff, 0xfdf6b2, 0xfecb5c, 0xf0703e, 0xa2296b, 0x3a1f78, 0x060a2a};
    const ShadedPicture picture = draw(Shading::depth);
    EXPECT_LT(worstColour(picture,
                          [&](int64_t x, int64_t y) {
                              return ramp(kStops, 2 * std::log10(static_cast<double>(picture.hit(x, y).w) / 100));
                          }),
              kByte);
}

TEST_F(ShadingTest, LevelIsThatOfTheHeightTile) {
    constexpr std::array<uint32_t, 3> kColours = {0x8a5fa8, 0x4c78b8, 0x57b5c4};
    std::set<uint32_t> seen;
    const ShadedPicture picture = draw(Shading::level, mixed());
    EXPECT_LT(worstTint(picture,
                        [&](int64_t x, int64_t y) {
                            seen.insert(picture.node(x, y).heightTile.level);
                            return legend(kColours.at(picture.node(x, y).heightTile.level));
                        }),
              kByte);
    EXPECT_GE(seen.size(), 2u);
}

TEST_F(ShadingTest, NormalDecodesToTheNormalTarget) {
    for (const double factor : {1.0, 2.5}) {
        const ShadedPicture picture = draw(Shading::normal, exaggerated(factor));
        EXPECT_LT(worstColour(picture, [&](int64_t x, int64_t y) { return 127.5 + 127.5 * picture.normal(x, y); }),
                  kByte);
    }
}

TEST_F(ShadingTest, SlopeIsInDegreesOfTheDatasetsGround) {
    constexpr std::array<uint32_t, 7> kStops = {0xf4f3ec, 0xc9deb0, 0xf5e27a, 0xf2a33f, 0xd9482f, 0x8f1d5c, 0x2d1140};
    for (const double factor : {1.0, 2.5}) {
        const ShadedPicture picture = draw(Shading::slope, exaggerated(factor));
        EXPECT_LT(worstColour(picture,
                              [&](int64_t x, int64_t y) {
                                  const glm::dvec3 n = picture.normal(x, y);
                                  const double rise = std::hypot(n.x, n.y) / n.z / factor;
                                  return ramp(kStops, degreesFromRadians(Radians(std::atan(rise))) / 10);
                              }),
                  kByte)
            << factor;
    }
}

TEST_F(ShadingTest, EachTileHasOneColourAndNoOtherTileHasIt) {
    const ShadedPicture picture = draw(Shading::tiles, mixed());
    std::map<TileId, Encoded> colours;
    EXPECT_LT(worstTint(picture,
                        [&](int64_t x, int64_t y) {
                            return colours.try_emplace(picture.node(x, y).heightTile, picture.tint(x, y)).first->second;
                        }),
              2 * kByte);
    ASSERT_GE(colours.size(), 4u);
    for (const auto& [tile, colour] : colours)
        for (const auto& [other, otherColour] : colours)
            if (tile != other) {
                EXPECT_GT(distance(colour, otherColour), 20) << tile << " and " << other;
            }
}

TEST_F(ShadingTest, ResidencyShowsWhoStandsInWhereTilesAreLost) {
    std::set<std::pair<bool, bool>> seen;
    const auto check = [&](const ShadedPicture& picture) {
        EXPECT_LT(worstTint(picture,
                            [&](int64_t x, int64_t y) {
                                const DrawNode& node = picture.node(x, y);
                                seen.insert({node.heightsExact, node.imageryExact});
                                if (node.heightsExact) return legend(node.imageryExact ? 0x9cc48b : 0x4f8fcb);
                                return legend(node.imageryExact ? 0xe8883c : 0xb03a6e);
                            }),
                  kByte);
    };
    check(draw(Shading::residency));
    check(draw(Shading::residency, {}, 1));  // the first frame has the roots alone
    for (const TileLayer layer : {TileLayer::heights, TileLayer::imagery}) {
        AnalyticDataset lossy({.finestLevel = 2, .imageryLevel = 2});
        for (uint32_t quadrant = 0; quadrant < 4; ++quadrant) lossy.lose(layer, TileId{}.child(quadrant));
        check(ShadedPicture(shaders_, lossy, Shading::residency, {}, camera_));
    }
    EXPECT_EQ(seen.size(), 4u);
}

TEST_F(ShadingTest, ErrorIsThatOfTheHeightTileOnTheScreenAgainstTheTolerance) {
    constexpr std::array<uint32_t, 7> kStops = {0x2f5fa6, 0x4fa3c7, 0x8cc79a, 0xe9e6a8, 0xf0973a, 0xd23a2e, 0x7a1450};
    EngineOptions starved = mixed();
    starved.gpuHeightBytes = 1'500'000;
    starved.exaggeration = 2;
    for (const EngineOptions& options : {mixed(), starved}) {
        const ShadedPicture picture = draw(Shading::error, options);
        int64_t over = 0;
        EXPECT_LT(worstTint(picture,
                            [&](int64_t x, int64_t y) {
                                const double error =
                                    picture.engine().tiles().heights(picture.node(x, y).heightTile)->record.error;
                                glm::dvec3 fromEye = picture.place(x, y) - camera_.position;
                                fromEye.z *= options.exaggeration;
                                const double pixels = options.exaggeration * error / glm::length(fromEye) *
                                                      picture.engine().view().focalPixels();
                                over += pixels > kTolerance;
                                const double place = std::log2(pixels / kTolerance) + 3;
                                return ramp(kStops, place > 3 ? std::max(place, 4.0) : place);
                            }),
                  kByte);
        if (options.gpuHeightBytes == starved.gpuHeightBytes) {
            EXPECT_GT(over, 1000);
        } else {
            EXPECT_EQ(over, 0) << "what is selected keeps the tolerance";
        }
    }
}

TEST_F(ShadingTest, SobelIsPaper003sLightOverNormalsOfASobelFilter) {
    EngineOptions bare = exaggerated(1.5);
    bare.selection.useImagery = false;
    const ShadedPicture picture = draw(Shading::sobel, bare);
    const glm::dvec3 sun = glm::normalize(RenderOptions().sunDirection);
    const glm::dvec3 ground = linear(legend(kNeutralGround[0] << 16 | kNeutralGround[1] << 8 | kNeutralGround[2]));
    std::map<TileId, HeightTile> tiles;
    EXPECT_LT(worstColour(picture,
                          [&](int64_t x, int64_t y) {
                              const TileId id = picture.node(x, y).heightTile;
                              if (!tiles.contains(id))
                                  tiles[id] = decodeHeightTile(*dataset_.read(TileLayer::heights, id), id).value();
                              const double scale = bare.exaggeration * tiles[id].encoding.metresPerCode() /
                                                   dataset_.metadata().tiling.spacing(id.level);
                              const glm::dvec2 rise = scale * sobel(tiles[id].codes, glm::dvec4(picture.hit(x, y)));
                              const glm::dvec3 normal = glm::normalize(glm::dvec3(-rise.x, rise.y, 1));
                              const glm::dvec3 toEye =
                                  glm::normalize((camera_.position - picture.place(x, y)) * glm::dvec3(1, 1, 1.5));
                              const double shine = glm::dot(normal, glm::normalize(sun + toEye));
                              return encodedFromLinear(0.5 * ground + 0.35 * std::max(glm::dot(sun, normal), 0.0) +
                                                       0.1 * std::pow(std::max(shine, 0.0), 20));
                          }),
              kByte);
    EXPECT_TRUE(draw(Shading::sobel).engine().targets().features().imagery) << "the photo, where there is one";
}

TEST_F(ShadingTest, StepsAreColouredFromBlackForNoneToWhiteForFifty) {
    constexpr std::array<uint32_t, 7> kStops = {0x000000, 0x2b1060, 0x8c1f6a, 0xd8413f, 0xf58a2e, 0xfad55c, 0xffffff};
    EngineOptions options;
    options.render.sunDirection = {0.8, 0.3, 0.25};
    for (const Launch launch : {Launch::raster, Launch::compute})
        for (const bool ofShadows : {false, true}) {
            options.render.launch = launch;
            options.render.shadows = ShadowOptions();
            const ShadedPicture picture = draw(ofShadows ? Shading::shadowSteps : Shading::steps, options);
            const FrameTargets& targets = picture.engine().targets();
            const Grid<uint32_t> steps = ofShadows ? targets.readShadowSteps() : targets.readSteps();
            double greatest = 0;
            uint32_t most = 0;
            for (int64_t y = 0; y < picture.height(); ++y)
                for (int64_t x = 0; x < picture.width(); ++x) {  // the sky's rays too
                    most = std::max(most, steps.at(x, y));
                    greatest =
                        std::max(greatest, distance(picture.colour(x, y), ramp(kStops, steps.at(x, y) * 6 / 50.0)));
                }
            EXPECT_LT(greatest, kByte) << name(launch) << ofShadows;
            EXPECT_GT(most, 10u);
        }
}

TEST_F(ShadingTest, NoShadowStepsAreShownWhileTheSunIsDown) {
    EngineOptions options;
    options.render.sunDirection = {0.8, 0.3, -0.1};
    options.render.shadows = ShadowOptions();
    const ShadedPicture picture = draw(Shading::shadowSteps, options);
    EXPECT_EQ(worstColour(picture, [](int64_t, int64_t) { return Encoded(0); }), 0);
}

TEST_F(ShadingTest, BothLaunchesDrawTheSameBytesInEveryMode) {
    for (const ShadingMode& mode : kShadingModes) {
        EngineOptions options = mixed();
        options.render.shading.mode = mode.shading;
        options.render.shadows = ShadowOptions();
        const auto draw = [&](Launch launch) {
            options.render.launch = launch;
            Engine engine(dataset_, shaders_, options, 157, 93);
            engine.drawFrame(camera_, true);
            return engine.targets().readSrgb();
        };
        EXPECT_TRUE(draw(Launch::raster) == draw(Launch::compute)) << mode.name;
    }
}

TEST_F(ShadingTest, AModeRunsNoPassWhoseWorkItDoesNotShow) {
    EngineOptions options;
    options.render.shadows = ShadowOptions();
    options.render.sky = true;
    options.render.visualRange = Metres(50000);
    EXPECT_GT(draw(Shading::contours, options).engine().targets().bytes(),
              draw(Shading::slope, options).engine().targets().bytes())
        << "no shadows under a slope's colours";
}

}  // namespace
}  // namespace terray
