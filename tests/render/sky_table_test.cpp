// The physical sky as its table holds it: what it shows for every sun and height, and when it is made anew.

#include "client/render/sky_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <gtest/gtest.h>

#include "shaders/interop.h"
#include "tests/render/gl_test.h"

namespace terray {
namespace {

double luminance(const glm::dvec3& colour) {
    return glm::dot(colour, glm::dvec3(0.2126, 0.7152, 0.0722));
}

/// A table read back; angles in degrees.
class ReadSky {
  public:
    explicit ReadSky(const SkyTable& table) : texels_(size_t{SkyTable::kWidth} * SkyTable::kHeight) {
        glGetTextureImage(table.texture().name(), 0, GL_RGBA, GL_FLOAT,
                          static_cast<GLsizei>(texels_.size() * sizeof(glm::vec4)), texels_.data());
        glGetNamedBufferSubData(table.parameters().name(), 0, sizeof(parameters), &parameters);
    }
    [[nodiscard]] const std::vector<glm::vec4>& texels() const { return texels_; }
    [[nodiscard]] glm::dvec3 texel(int column, int row) const {
        return glm::dvec3(texels_[static_cast<size_t>(row) * SkyTable::kWidth + static_cast<size_t>(column)]);
    }
    [[nodiscard]] double horizon() const { return degreesFromRadians(Radians(parameters.shown.w)); }
    /// The nearest texel, as shaders/sky/place.glsl places it.
    [[nodiscard]] glm::dvec3 colour(double azimuth, double elevation) const {
        const int middle = SkyTable::kHeight / 2;
        const double reach = elevation >= horizon() ? 90 - horizon() : -90 - horizon();
        const double away = std::sqrt((elevation - horizon()) / reach) * (middle - 1);
        const auto column = std::lround(std::sqrt(azimuth / 180) * (SkyTable::kWidth - 1));
        const auto row = std::lround(elevation >= horizon() ? middle + away : middle - 1 - away);
        return texel(static_cast<int>(column), static_cast<int>(row));
    }
    interop::SkyParameters parameters;

  private:
    std::vector<glm::vec4> texels_;
};

class SkyTableTest : public GlTest {
  protected:
    ReadSky sky(double sunElevation, double eyeHeight = 2) {
        table_.update({.eyeHeight = Metres(eyeHeight), .sunElevation = radiansFromDegrees(sunElevation)});
        return ReadSky(table_);
    }
    ShaderLibrary shaders_;
    SkyTable table_{shaders_, {}};
};

constexpr double kEyes[] = {-50, 0, 2, 300, 4000, 12000, 90000, 400000};

TEST_F(SkyTableTest, IsFiniteForEverySunFromEveryHeight) {
    for (const double eye : kEyes)
        for (const double sun : {-90.0, -18.0, -6.0, -0.3, 0.0, 0.3, 10.0, 89.99, 90.0}) {
            const ReadSky read = sky(sun, eye);
            for (const glm::vec4& texel : read.texels())
                for (int channel = 0; channel < 3; ++channel) {
                    ASSERT_TRUE(std::isfinite(texel[channel])) << eye << " " << sun;
                    ASSERT_GE(texel[channel], 0) << eye << " " << sun;
                    ASSERT_LT(texel[channel], 1) << eye << " " << sun;
                }
            for (int i = 0; i < TERRAY_SKY_LIGHTS; ++i)
                for (const glm::vec4& light : {read.parameters.sunLight[i], read.parameters.skyLight[i]})
                    ASSERT_TRUE(std::isfinite(luminance(glm::dvec3(light))) && light.x >= 0) << eye << " " << sun;
        }
}

TEST_F(SkyTableTest, IsBrighterTowardsTheSun) {
    for (const double sun : {-4.0, 1.0, 10.0, 30.0, 60.0}) {
        const ReadSky read = sky(sun);
        // In each row from the horizon up, from the sun's azimuth to a right angle from it (column 135).
        for (int row = SkyTable::kHeight / 2; row < SkyTable::kHeight - 1; ++row) {
            EXPECT_GT(luminance(read.texel(0, row)), luminance(read.texel(135, row))) << sun << " " << row;
            for (int column = 1; column <= 135; ++column)
                ASSERT_LE(luminance(read.texel(column, row)), 1.01 * luminance(read.texel(column - 1, row)))
                    << sun << " " << column << " " << row;
        }
    }
    // A low sun's surroundings are the brightest of all.
    const ReadSky read = sky(8);
    for (int row = 0; row < SkyTable::kHeight; ++row)
        for (int column = 0; column < SkyTable::kWidth; ++column)
            ASSERT_LE(luminance(read.texel(column, row)), 1.001 * luminance(read.colour(0, 8))) << column << " " << row;
}

TEST_F(SkyTableTest, ByDayTheHorizonIsBrightAndTheZenithBlue) {
    for (const double sun : {40.0, 60.0}) {
        const ReadSky read = sky(sun);
        const glm::dvec3 zenith = read.colour(180, 90);
        EXPECT_GT(luminance(read.colour(90, 1)), 2 * luminance(zenith)) << sun;
        EXPECT_GT(zenith.b, (sun < 50 ? 1.8 : 1.5) * zenith.g) << sun;  // higher, the sun's glow reaches it
        EXPECT_GT(zenith.g, 1.3 * zenith.r) << sun;
    }
    // From 12 km the zenith is darker, and the horizon lies lower.
    const double fromGround = luminance(sky(40, 2).colour(180, 90));
    const ReadSky high = sky(40, 12000);
    EXPECT_LT(luminance(high.colour(180, 90)), 0.6 * fromGround);
    EXPECT_NEAR(high.horizon(), -3.513, 0.01);  // acos(R / (R + h))
}

TEST_F(SkyTableTest, ALowSunIsRed) {
    const ReadSky read = sky(1);
    const glm::dvec3 beside = read.colour(2, 1);
    EXPECT_GT(beside.r, 1.3 * beside.g);
    EXPECT_GT(beside.g, 2 * beside.b);
    // So is its disc, and the zenith stays blue: ozone takes its red.
    EXPECT_GT(read.parameters.disc.x, 2 * read.parameters.disc.y);
    EXPECT_GT(sky(-4).colour(90, 90).b, 1.5 * sky(-4).colour(90, 90).r);
}

TEST_F(SkyTableTest, DimsThroughTwilightWithoutAStep) {
    double lastZenith = 1;
    double lastLight = 1;
    for (double sun = 3; sun >= -18; sun -= 0.5) {
        const ReadSky read = sky(sun);
        const double zenith = luminance(read.colour(90, 90));
        const double light = luminance(glm::dvec3(read.parameters.skyLight[0]));
        EXPECT_LT(light, lastLight) << sun;
        EXPECT_LT(zenith, 1.002 * lastZenith) << sun;
        if (sun < 3) {
            EXPECT_GT(zenith, 0.7 * lastZenith) << sun;
            EXPECT_GT(light, 0.7 * lastLight) << sun;
        }
        lastZenith = zenith;
        lastLight = light;
    }
    // Night is dark, not black.
    EXPECT_LT(lastLight, 0.05);
    EXPECT_GT(lastZenith, 0.001);
}

TEST_F(SkyTableTest, AtFortyDegreesLightIsAsWithoutIt) {
    const ReadSky read = sky(40);
    for (int i = 0; i < TERRAY_SKY_LIGHTS; ++i) {
        // shaders/daylight.glsl
        EXPECT_LT(glm::length(glm::dvec3(read.parameters.sunLight[i]) - glm::dvec3(1.22, 1.16, 1.08)), 2e-3) << i;
        EXPECT_LT(glm::length(glm::dvec3(read.parameters.skyLight[i]) - glm::dvec3(0.22, 0.25, 0.30)), 2e-3) << i;
    }
}

TEST_F(SkyTableTest, SummitsAreLitLonger) {
    // The horizon of 4.3 km lies 2.1 degrees down.
    const interop::SkyParameters after = sky(-1).parameters;
    const int summit = 15;  // 4355 m
    EXPECT_EQ(luminance(glm::dvec3(after.sunLight[0])), 0);
    EXPECT_GT(after.sunLight[summit].x, 0.1);
    EXPECT_GT(after.sunLight[summit].x, 3 * after.sunLight[summit].y);
    const interop::SkyParameters later = sky(-3).parameters;
    EXPECT_EQ(luminance(glm::dvec3(later.sunLight[summit])), 0);
}

/// Optical depth of the air towards a sun, in double, by even steps of a metre of height or less: none of the shaders'
/// code. Molecules, aerosol and ozone as math/atmosphere.glsl states them.
glm::dvec3 opticalDepth(double fromHeight, double elevationDegrees, double visualRange) {
    constexpr double kRadius = 6371000;
    const double sine = std::sin(radiansFromDegrees(elevationDegrees).value());
    const double green = 3.912 / visualRange - 12.096e-6;
    const auto distance = [&](double height) {
        const double r = kRadius + fromHeight;
        return -r * sine + std::sqrt(r * r * sine * sine + (height - fromHeight) * (2 * kRadius + height + fromHeight));
    };
    glm::dvec3 depth(0);
    constexpr int kSteps = 100000;
    for (int i = 0; i < kSteps; ++i) {
        const double lower = fromHeight + (100000 - fromHeight) * i / kSteps;
        const double upper = fromHeight + (100000 - fromHeight) * (i + 1) / kSteps;
        const double height = 0.5 * (lower + upper);
        const double step = distance(upper) - distance(lower);
        depth += step * std::exp(-height / 8434) * glm::dvec3(6.440e-6, 12.096e-6, 28.200e-6);
        depth += step * std::exp(-height / 1200) * green * glm::dvec3(0.8176, 1, 1.3067);
        depth += step * std::max(0.0, 1 - std::abs(height - 25000) / 15000) * glm::dvec3(1.609e-6, 1.727e-6, 0.0929e-6);
    }
    return depth;
}

TEST_F(SkyTableTest, SunlightIsWhatTheAirLetsThrough) {
    const interop::SkyParameters day = sky(40).parameters;
    for (const double sun : {2.0, 5.0, 15.0, 70.0}) {
        const interop::SkyParameters now = sky(sun).parameters;
        for (const int level : {0, 10, 31}) {
            const double height = TERRAY_SKY_TOP_LIGHT * level / (TERRAY_SKY_LIGHTS - 1);
            // Relative to 40 degrees, and channels relative to green, so that exposure does not matter.
            const glm::dvec3 change = glm::dvec3(now.sunLight[level]) / glm::dvec3(day.sunLight[level]);
            const glm::dvec3 expected = glm::exp(opticalDepth(height, 40, 80000) - opticalDepth(height, sun, 80000));
            // 64 steps through the air and a table of 256 angles: within 1 %, of the deep blue at 2 degrees within 3 %.
            EXPECT_NEAR(change.r / change.g * expected.g / expected.r, 1, 0.01) << sun << " at " << height;
            EXPECT_NEAR(change.b / change.g * expected.g / expected.b, 1, 0.03) << sun << " at " << height;
        }
    }
}

TEST_F(SkyTableTest, SkyAndWhatLiesBelowItMeetWithoutALine) {
    const int middle = SkyTable::kHeight / 2;
    for (const double eye : {2.0, 300.0, 4000.0, 12000.0})
        for (const double sun : {60.0, 10.0, 1.0, -4.0}) {
            const ReadSky read = sky(sun, eye);
            for (const int column : {0, 40, 100, 191}) {
                const glm::dvec3 above = read.texel(column, middle);
                const glm::dvec3 below = read.texel(column, middle - 1);
                EXPECT_LT(glm::length(above - below), 0.01 * glm::length(above)) << eye << " " << sun << " " << column;
            }
        }
}

TEST(SkyView, LooksOtherWhenSunOrHorizonHasMovedByHalfAPixel) {
    const auto view = [](double height, double sunDegrees) {
        return SkyView{.eyeHeight = Metres(height), .sunElevation = radiansFromDegrees(sunDegrees)};
    };
    EXPECT_FALSE(looksOther(view(1000, 10), view(1000, 10)));
    EXPECT_FALSE(looksOther(view(1000, 10), view(1000, 10.029)));
    EXPECT_TRUE(looksOther(view(1000, 10), view(1000, 9.969)));
    // The horizon of 1 km lies 1.015 degrees down; 59 m move it by 0.03.
    EXPECT_FALSE(looksOther(view(1000, 10), view(1058, 10)));
    EXPECT_TRUE(looksOther(view(1000, 10), view(1062, 10)));
    // Nobody looks from below the sea.
    EXPECT_FALSE(looksOther(view(-400, 10), view(0, 10)));
}

TEST_F(SkyTableTest, IsMadeAnewOnlyWhenItLooksOther) {
    EXPECT_TRUE(table_.update({.eyeHeight = Metres(1000), .sunElevation = radiansFromDegrees(10)}));
    const ReadSky first(table_);
    EXPECT_FALSE(table_.update({.eyeHeight = Metres(1058), .sunElevation = radiansFromDegrees(10.029)}));
    EXPECT_EQ(ReadSky(table_).texels(), first.texels());
    // Many small steps add up.
    bool made = false;
    for (int i = 1; i <= 10; ++i)
        made |= table_.update({.eyeHeight = Metres(1000), .sunElevation = radiansFromDegrees(10 + 0.01 * i)});
    EXPECT_TRUE(made);
}

TEST_F(SkyTableTest, WhatIsNotNoticedIsBelowAStepOfABrightPicture) {
    // Both thresholds at once, at a rising sun and in twilight: 0.03 degrees of each.
    const auto shown = [](double linear) { return 255 * (1.055 * std::pow(linear, 1 / 2.4) - 0.055); };
    for (const double sun : {20.0, 2.0, -4.0, -8.0})
        for (const double eye : {100.0, 3000.0}) {
            const ReadSky before = sky(sun, eye);
            SkyTable other(shaders_, {});
            other.update({.eyeHeight = Metres(1.02 * eye), .sunElevation = radiansFromDegrees(sun + 0.03)});
            const ReadSky after(other);
            double sum = 0;
            for (size_t i = 0; i < before.texels().size(); ++i)
                sum += std::abs(shown(before.texels()[i].y) - shown(after.texels()[i].y));
            EXPECT_LT(sum / static_cast<double>(before.texels().size()), 1) << sun << " " << eye;
        }
}

TEST_F(SkyTableTest, FarAirIsTheHorizon) {
    SkyTable table(shaders_, {.visualRange = Metres(40000), .airlight = true});
    for (const double sun : {60.0, 10.0, 1.0, -4.0}) {
        table.update({.eyeHeight = Metres(2), .sunElevation = radiansFromDegrees(sun)});
        const ReadSky read(table);
        std::vector<glm::vec4> air(size_t{SkyTable::kAirWidth} * SkyTable::kAirHeight * SkyTable::kAirSlices);
        glGetTextureImage(table.airTexture().name(), 0, GL_RGBA, GL_FLOAT,
                          static_cast<GLsizei>(air.size() * sizeof(glm::vec4)), air.data());
        for (const glm::vec4& texel : air) ASSERT_TRUE(std::isfinite(texel.x + texel.y + texel.z) && texel.x >= 0);
        for (const int column : {0, SkyTable::kAirWidth / 2, SkyTable::kAirWidth - 1}) {
            const size_t row = SkyTable::kAirHeight / 2;  // the horizon
            const size_t slice = SkyTable::kAirSlices - 1;
            const glm::dvec3 far(
                air[(slice * SkyTable::kAirHeight + row) * SkyTable::kAirWidth + static_cast<size_t>(column)]);
            const double share = static_cast<double>(column) / (SkyTable::kAirWidth - 1);
            const glm::dvec3 horizon = read.colour(180 * share * share, read.horizon());
            EXPECT_LT(glm::length(far - horizon), 0.03 * glm::length(horizon)) << sun << " " << column;
        }
    }
}

TEST_F(SkyTableTest, HoldsNoAirWhenNoneIsAskedFor) {
    EXPECT_EQ(table_.airTexture().name(), 0u);
    const SkyTable with(shaders_, {.airlight = true});
    EXPECT_NE(with.airTexture().name(), 0u);
    EXPECT_EQ(with.bytes() - table_.bytes(),
              uint64_t{SkyTable::kAirWidth} * SkyTable::kAirHeight * SkyTable::kAirSlices * 8);
}

}  // namespace
}  // namespace terray
