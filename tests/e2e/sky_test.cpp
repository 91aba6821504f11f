// Physical sky and aerial perspective in whole pictures.

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "common/error.h"
#include "common/sun_position.h"
#include "tests/e2e/scene.h"

namespace terray {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 90;

/// Long gentle waves at 1 km of height.
float waves(int64_t column, int64_t row) {
    return static_cast<float>(1000 + 30 * std::sin(static_cast<double>(column) / 40) +
                              30 * std::cos(static_cast<double>(row) / 60));
}

class SkyPicture : public testing::Test {
  protected:
    HeadlessContext context_{HeadlessContext::Options{.debug = true}};
    ShaderLibrary shaders_;
    ComputedDataset dataset_{waves, {1024, 1024}, 10};
    void TearDown() override { EXPECT_EQ(context_.takeDebugMessages(), ""); }

    static EngineOptions underSun(double elevationDegrees, bool sky) {
        EngineOptions options;
        options.colour = ColourFormat::linearFloat;
        options.render.launch = Launch::raster;
        options.render.sunDirection =
            directionOf({.azimuth = Radians(4), .elevation = radiansFromDegrees(elevationDegrees)});
        options.render.sky = sky;
        return options;
    }
    /// The picture, with alpha 1 where there is ground and 0 where there is sky.
    Grid<glm::vec4> draw(const EngineOptions& options, double pitch = -3) {
        Engine engine(dataset_.source(), shaders_, options, kWidth, kHeight);
        engine.drawFrame(cameraAt({6000, -4000, 1200}, 20, pitch, 50), true);
        Grid<glm::vec4> picture = engine.targets().readLinear();
        const auto nodes = engine.targets().readNodes();
        for (size_t i = 0; i < nodes.cells().size(); ++i) picture.cells()[i].a = nodes.cells()[i] != 0 ? 1 : 0;
        return picture;
    }
    static glm::dvec3 meanGround(const Grid<glm::vec4>& picture) {
        glm::dvec4 sum(0);
        for (const glm::vec4& pixel : picture.cells()) sum += glm::dvec4(pixel * pixel.a);
        EXPECT_GT(sum.a, 1000);
        return glm::dvec3(sum) / sum.a;
    }
};

TEST_F(SkyPicture, AtFortyDegreesGroundLooksAsItDoesWithoutIt) {
    const auto without = draw(underSun(40, false));
    const auto with = draw(underSun(40, true));
    int64_t ground = 0;
    for (size_t i = 0; i < without.cells().size(); ++i) {
        if (without.cells()[i].a == 0) continue;
        ++ground;
        const glm::vec3 expected(without.cells()[i]);
        ASSERT_LT(glm::length(glm::vec3(with.cells()[i]) - expected), 0.005f * glm::length(expected));
    }
    EXPECT_GT(ground, 1000);
}

TEST_F(SkyPicture, TheSinkingSunDimsAndReddensTheGround) {
    glm::dvec3 last = meanGround(draw(underSun(40, true)));
    double lastRedness = last.r / last.b;
    for (const double sun : {15.0, 6.0, 2.0}) {
        const glm::dvec3 ground = meanGround(draw(underSun(sun, true)));
        EXPECT_LT(ground.g, last.g) << sun;
        EXPECT_GT(ground.r / ground.b, lastRedness) << sun;
        last = ground;
        lastRedness = ground.r / ground.b;
    }
    // Without the sky a sun below the horizon still lights slopes that face it; with it, night is dark.
    const glm::dvec3 night = meanGround(draw(underSun(-20, true)));
    EXPECT_LT(night.g, 0.05 * last.g);
    EXPECT_GT(night.g, 0);
}

TEST_F(SkyPicture, AirFadesTheFarMoreThanTheNear) {
    EngineOptions options = underSun(40, true);
    const auto clear = draw(options);
    options.render.visualRange = Metres(20000);
    const auto hazy = draw(options);
    // Up a column of ground, from near to far, what the air adds grows.
    double last = 0;
    int64_t rows = 0;
    for (int64_t y = kHeight - 1; y >= 0; y -= 8) {
        if (clear.at(kWidth / 2, y).a == 0) break;
        ++rows;
        const double haze = hazy.at(kWidth / 2, y).b - 0.95 * clear.at(kWidth / 2, y).b;
        EXPECT_GT(haze, last) << y;
        last = haze;
    }
    EXPECT_GT(rows, 3);
    // Sky stays sky.
    EXPECT_EQ(hazy.at(kWidth / 2, 0).a, 0);
}

TEST_F(SkyPicture, IsMadeOnlyWhenItIsOn) {
    const auto bufferBytes = [&](const EngineOptions& options) {
        Engine engine(dataset_.source(), shaders_, options, kWidth, kHeight);
        return engine.drawFrame(cameraAt({6000, -4000, 1200}, 20, -3, 50), true).gpuBuffers;
    };
    const uint64_t without = bufferBytes(underSun(40, false));
    const uint64_t with = bufferBytes(underSun(40, true));
    EXPECT_LT(without, 20'000u);
    EXPECT_GT(with, without + 200'000);  // the tables
    EXPECT_LT(with, without + 1'000'000);
}

TEST_F(SkyPicture, ATimeOfDayNeedsToKnowWhereTheGroundLies) {
    EngineOptions options = underSun(40, false);
    options.sunTime = parseUtcTime("2026-06-21T12:00Z").value();
    try {
        Engine engine(dataset_.source(), shaders_, options, kWidth, kHeight);
        FAIL() << "a dataset without a coordinate system has no time of day";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::georeference);
        EXPECT_NE(std::string(error.what()).find("--sun AZIMUTH,ELEVATION"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace terray
