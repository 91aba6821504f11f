// How colours are rounded to bytes: shaders/srgb.glsl, run on a square of pixels of one colour.

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "client/render/feature_set.h"
#include "client/render/shader_library.h"
#include "common/grid.h"
#include "tests/render/gl_test.h"

namespace terray {
namespace {

constexpr int kSide = 64;
using Bytes = Grid<std::array<uint8_t, 4>>;

const ShaderFiles kFill = {{"fill.comp", R"glsl(
#include "srgb.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, rgba8) writeonly uniform image2D picture;
layout(location = 0) uniform vec3 colour;
void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    imageStore(picture, pixel, vec4(storedColour(colour, pixel), 1.0));
}
)glsl"}};

double linearFromSrgb(double srgb) {
    return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

class Srgb : public GlTest {
  protected:
    Srgb() : program_(ShaderLibrary(folder_.path()).require({"fill.comp"}, FeatureSet().defines())) {
        glTextureStorage2D(picture_.name(), 1, GL_RGBA8, kSide, kSide);
    }

    Bytes fill(float r, float g, float b) {
        glUseProgram(program_.name());
        glUniform3f(0, r, g, b);
        glBindImageTexture(0, picture_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
        glDispatchCompute(kSide / 8, kSide / 8, 1);
        glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
        Bytes bytes({kSide, kSide});
        glGetTextureImage(picture_.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE,
                          static_cast<GLsizei>(bytes.cells().size_bytes()), bytes.cells().data());
        return bytes;
    }

    ShaderFolder folder_{kFill};
    GlProgram program_;
    GlTexture picture_ = makeTexture(GL_TEXTURE_2D);
};

TEST_F(Srgb, WhatIsAByteStaysThatByteInEveryPixel) {
    for (int value = 0; value < 256; ++value) {
        const auto linear = static_cast<float>(linearFromSrgb(value / 255.0));
        const Bytes bytes = fill(linear, linear, linear);
        const auto byte = static_cast<uint8_t>(value);
        const std::array<uint8_t, 4> expected = {byte, byte, byte, 255};
        EXPECT_EQ(std::ranges::count(bytes.cells(), expected), kSide * kSide) << value;
    }
    const std::array<uint8_t, 4> signal = {255, 0, 255, 255};
    const Bytes magenta = fill(1, 0, 1);
    EXPECT_EQ(std::ranges::count(magenta.cells(), signal), kSide * kSide);
    const Bytes outOfRange = fill(7, -3, 1.5f);
    EXPECT_EQ(std::ranges::count(outOfRange.cells(), signal), kSide * kSide);
}

TEST_F(Srgb, WhatLiesBetweenBytesIsRightOnAverageAndOffByLessThanOne) {
    for (const double value : {0.3, 4.5, 10.25, 99.9, 180.04, 253.75}) {
        const auto linear = static_cast<float>(linearFromSrgb(value / 255.0));
        const Bytes bytes = fill(linear, linear, linear);
        for (size_t channel = 0; channel < 3; ++channel) {
            double sum = 0;
            for (const auto& texel : bytes.cells()) {
                ASSERT_LT(std::abs(texel[channel] - value), 1) << value;
                sum += texel[channel];
            }
            EXPECT_NEAR(sum / (kSide * kSide), value, 1.0 / 64) << channel;
        }
    }
}

TEST_F(Srgb, NoPatternIsSeen) {
    // Half of the pixels of each 8 x 8 square are the upper byte, to a few; the eye then finds no larger shapes.
    const auto linear = static_cast<float>(linearFromSrgb(100.5 / 255.0));
    const Bytes bytes = fill(linear, linear, linear);
    for (int y = 0; y < kSide; y += 8)
        for (int x = 0; x < kSide; x += 8) {
            int upper = 0;
            for (int j = 0; j < 8; ++j)
                for (int i = 0; i < 8; ++i) upper += bytes.at(x + i, y + j)[0] == 101 ? 1 : 0;
            EXPECT_NEAR(upper, 32, 4);
        }
    // Nor do all channels step in the same pixels.
    const auto same = [](const std::array<uint8_t, 4>& texel) { return texel[0] == texel[1] && texel[1] == texel[2]; };
    EXPECT_LT(std::ranges::count_if(bytes.cells(), same), kSide * kSide / 10);
}

}  // namespace
}  // namespace terray
