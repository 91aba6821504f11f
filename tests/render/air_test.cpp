// Aerial perspective as shaders/air.glsl computes it, one colour at a time.

#include <cmath>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <gtest/gtest.h>

#include "client/render/feature_set.h"
#include "client/render/shader_library.h"
#include "client/render/sky_table.h"
#include "shaders/interop.h"
#include "tests/render/gl_test.h"

namespace terray {
namespace {

const ShaderFiles kProbe = {{"probe.comp", R"glsl(
#include "air.glsl"
#include "nodes.glsl"
layout(local_size_x = 1) in;
layout(std430, binding = 7) buffer Result { vec4 result[]; };
layout(location = 20) uniform vec3 colour;
layout(location = 21) uniform vec3 direction;
layout(location = 22) uniform vec2 distanceAndHeight;
void main() {
    vec3 toward = normalize(direction);
    result[0] = vec4(throughAir(colour, toward, distanceAndHeight.x, distanceAndHeight.y), 0.0);
    result[1] = vec4(skyThroughAir(colour, toward), 0.0);
    result[2] = vec4(skyColour(toward, frame.sun.xyz), 0.0);
}
)glsl"}};

constexpr double kRange = 40000;

class AirTest : public GlTest {
  protected:
    AirTest() {
        glNamedBufferStorage(result_.name(), 3 * sizeof(glm::vec4), nullptr, 0);
        glNamedBufferStorage(frame_.name(), sizeof(interop::FrameParameters), nullptr, GL_DYNAMIC_STORAGE_BIT);
    }

    struct Probed {
        glm::dvec3 ground, sky, skyColour;
    };
    struct Path {
        glm::vec3 direction{1, 0, 0};
        double distance = 0;
        double eyeHeight = 0;
        double height = 0;
    };
    /// A colour through the air of a visual range of 40 km, under a sun in the south-west at 30 degrees.
    Probed through(const FeatureSet& features, glm::vec3 colour, const Path& path) {
        const GlProgram program = shaders_.require({"probe.comp"}, features.defines());
        interop::FrameParameters frame{};
        frame.up = {0, 0, 0.5f, 720};
        frame.sun = {-0.612f, -0.612f, 0.5f, 0};
        frame.air = {kRange, path.eyeHeight, 1, 0};
        glNamedBufferSubData(frame_.name(), 0, sizeof(frame), &frame);
        if (features.sky) {
            table_.update({.eyeHeight = Metres(path.eyeHeight), .sunElevation = radiansFromDegrees(30)});
            table_.bind();
        }
        glBindBufferBase(GL_UNIFORM_BUFFER, TERRAY_BUFFER_FRAME, frame_.name());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 7, result_.name());
        glUseProgram(program.name());
        glUniform3fv(20, 1, &colour.x);
        glUniform3fv(21, 1, &path.direction.x);
        glUniform2f(22, static_cast<float>(path.distance), static_cast<float>(path.height));
        glDispatchCompute(1, 1, 1);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        glm::vec4 result[3];
        glGetNamedBufferSubData(result_.name(), 0, sizeof(result), result);
        return {glm::dvec3(result[0]), glm::dvec3(result[1]), glm::dvec3(result[2])};
    }

    ShaderFolder folder_{kProbe};
    ShaderLibrary shaders_{folder_.path()};
    SkyTable table_{shaders_, {.visualRange = Metres(kRange), .airlight = true}};
    GlBuffer result_ = makeBuffer();
    GlBuffer frame_ = makeBuffer();
};

constexpr FeatureSet kAir{.air = true};
constexpr FeatureSet kAirAndSky{.sky = true, .air = true};
constexpr glm::vec3 kBlack{0};
constexpr glm::vec3 kWhite{1};

TEST_F(AirTest, OffNothingChanges) {
    const glm::vec3 colour{0.25f, 0.5f, 0.125f};
    for (const FeatureSet& features : {FeatureSet{}, FeatureSet{.sky = true}}) {
        const Probed seen = through(features, colour, {.distance = 1e6});
        EXPECT_EQ(seen.ground, glm::dvec3(colour));
        EXPECT_EQ(seen.sky, glm::dvec3(colour));
    }
}

TEST_F(AirTest, AtTheVisualRangeTwoPercentOfContrastAreLeft) {
    for (const FeatureSet& features : {kAir, kAirAndSky}) {
        const Path level{.distance = kRange};
        const glm::dvec3 contrast = through(features, kWhite, level).ground - through(features, kBlack, level).ground;
        // exp(-3.912) for green (Koschmieder); blue is dimmed more and red less, by molecules and aerosol each its way.
        EXPECT_NEAR(contrast.g, 0.02, 1e-5);
        EXPECT_LT(contrast.b, 0.01);
        EXPECT_GT(contrast.r, 0.03);
    }
    // The black target against the endless air behind it: what is missing of its light.
    const glm::dvec3 target = through(kAir, kBlack, {.distance = kRange}).ground;
    const glm::dvec3 endless = through(kAir, kBlack, {.distance = 1e9}).ground;
    EXPECT_NEAR((endless.g - target.g) / endless.g, 0.02, 1e-5);
}

TEST_F(AirTest, NearbyNothingIsLost) {
    for (const FeatureSet& features : {kAir, kAirAndSky}) {
        const Probed seen = through(features, kWhite, {.distance = 1});
        EXPECT_NEAR(seen.ground.g, 1, 2e-4);
    }
}

TEST_F(AirTest, FarRidgesTurnBlue) {
    // A dark ridge at a third of the range: the light that the air adds is bluer than the horizon itself.
    for (const FeatureSet& features : {kAir, kAirAndSky}) {
        const glm::dvec3 ridge = through(features, kBlack, {.distance = kRange / 3}).ground;
        const glm::dvec3 endless = through(features, kBlack, {.distance = 1e9}).ground;
        EXPECT_GT(ridge.b / ridge.r, 1.15 * endless.b / endless.r);
    }
}

TEST_F(AirTest, IsSteadyWhereHeightsAreEqual) {
    // The same path a millimetre or a metre aslant: no jump, no NaN.
    const glm::dvec3 level = through(kAir, kWhite, {.distance = 20000, .eyeHeight = 1500, .height = 1500}).ground;
    for (const double step : {-1.0, -1e-3, 1e-3, 1.0}) {
        const Path aslant{.distance = 20000, .eyeHeight = 1500, .height = 1500 + step};
        const glm::dvec3 seen = through(kAir, kWhite, aslant).ground;
        for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(seen[channel], level[channel], 3e-4) << step;
    }
    EXPECT_LT(level.r, 1);
}

TEST_F(AirTest, IsThinnerHigherUp) {
    double last = 0;
    for (const double height : {0.0, 1000.0, 3000.0, 9000.0}) {
        const Path path{.distance = kRange, .eyeHeight = height, .height = height};
        const double contrast = through(kAir, kWhite, path).ground.g - through(kAir, kBlack, path).ground.g;
        EXPECT_GT(contrast, 1.5 * last) << height;
        last = contrast;
    }
}

TEST_F(AirTest, GroundAndSkyMeetInTheHaze) {
    // The gradient's sky goes over into what endless ground looks like, from whatever height.
    for (const double eye : {2.0, 12000.0})
        for (const glm::vec3 direction : {glm::vec3(1, 0, 0), glm::vec3(-1, -1, 0), glm::vec3(0, 1, 0)}) {
            const glm::dvec3 ground =
                through(kAir, kBlack, {.direction = direction, .distance = 1e7, .eyeHeight = eye}).ground;
            const glm::vec3 horizon(through(kAir, kBlack, {.direction = direction, .eyeHeight = eye}).skyColour);
            const glm::dvec3 sky = through(kAir, horizon, {.direction = direction, .eyeHeight = eye}).sky;
            for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(sky[channel], ground[channel], 2e-3) << eye;
        }
    // Straight up the sky stays as it is, but for the air's own light.
    const Path up{.direction = {0, 0, 1}, .eyeHeight = 2};
    const Probed zenith = through(kAir, glm::vec3(through(kAir, kBlack, up).skyColour), up);
    EXPECT_LT(zenith.sky.r, 2 * zenith.skyColour.r);
}

TEST_F(AirTest, TheTablesSkyHasItsAirAlready) {
    for (const glm::vec3 direction : {glm::vec3(1, 0, 0), glm::vec3(0, 0, 1), glm::vec3(1, 0, -1)}) {
        const Probed seen = through(kAirAndSky, glm::vec3(0.25f, 0.5f, 0.125f), {.direction = direction});
        EXPECT_EQ(seen.sky, glm::dvec3(0.25, 0.5, 0.125));
    }
}

TEST_F(AirTest, TheSunAndItsOppositeStraightUpAndDownAreNumbers) {
    for (const glm::vec3 direction : {glm::vec3(0, 0, 1), glm::vec3(0, 0, -1), glm::vec3(-0.612f, -0.612f, 0.5f),
                                      glm::vec3(0.612f, 0.612f, -0.5f)}) {
        const Probed seen = through(kAirAndSky, kWhite, {.direction = direction, .distance = 5000, .eyeHeight = 300});
        EXPECT_TRUE(std::isfinite(seen.skyColour.r + seen.skyColour.g + seen.skyColour.b));
        EXPECT_TRUE(std::isfinite(seen.ground.r + seen.ground.g + seen.ground.b));
    }
    // The disc is white by day and stands out from what is a degree beside it.
    const Probed disc = through(kAirAndSky, kWhite, {.direction = {-0.612f, -0.612f, 0.5f}, .eyeHeight = 300});
    const Probed beside = through(kAirAndSky, kWhite, {.direction = {-0.612f, -0.612f, 0.52f}, .eyeHeight = 300});
    EXPECT_GT(disc.skyColour.b, 0.97);
    EXPECT_LT(beside.skyColour.r, 0.95 * disc.skyColour.r);
}

}  // namespace
}  // namespace terray
