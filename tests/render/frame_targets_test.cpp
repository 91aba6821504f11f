#include "client/render/frame_targets.h"

#include "tests/render/gl_test.h"

namespace terray {
namespace {

using FrameTargetsTest = GlTest;

// Odd on purpose: rows that are no multiple of four bytes.
constexpr int kWidth = 7;
constexpr int kHeight = 5;
// A texel that no flip or transposition maps to itself, in GL's count (from the bottom) and in the picture's.
constexpr int kColumn = 2;
constexpr int kGlRow = 1;
constexpr int kPictureRow = kHeight - 1 - kGlRow;

constexpr FeatureSet kAllFeatures = {.imagery = true, .statistics = true, .normals = true, .signalSky = true};

/// Writes one texel.
void mark(const GlTexture& texture, GLenum format, GLenum type, const void* value) {
    glTextureSubImage2D(texture.name(), 0, kColumn, kGlRow, 1, 1, format, type, value);
}

/// Expects `marked` at the marked texel and `rest` everywhere else.
template <class T>
void expectOneMark(const Grid<T>& grid, const T& marked, const T& rest) {
    ASSERT_EQ(grid.size(), (GridSize{kWidth, kHeight}));
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            EXPECT_EQ(grid.at(x, y), x == kColumn && y == kPictureRow ? marked : rest) << x << ", " << y;
        }
    }
}

TEST_F(FrameTargetsTest, ColoursAreReadTopRowFirst) {
    const FrameTargets targets(kWidth, kHeight, {});
    glClearTexImage(targets.colour.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    const std::array<uint8_t, 4> value = {10, 20, 30, 40};
    mark(targets.colour, GL_RGBA, GL_UNSIGNED_BYTE, value.data());
    expectOneMark<std::array<uint8_t, 4>>(targets.readSrgb(), {10, 20, 30, 255}, {0, 0, 0, 255});
}

TEST_F(FrameTargetsTest, LinearColoursAreReadTopRowFirst) {
    const FrameTargets targets(kWidth, kHeight, {}, ColourFormat::linearFloat);
    glClearTexImage(targets.colour.name(), 0, GL_RGBA, GL_FLOAT, nullptr);
    const glm::vec4 value(0.25F, 2, 1024, 1);  // exact in half floats
    mark(targets.colour, GL_RGBA, GL_FLOAT, &value);
    expectOneMark(targets.readLinear(), value, glm::vec4(0));
}

TEST_F(FrameTargetsTest, HitsNodesStepsAndNormalsAreReadTopRowFirst) {
    const FrameTargets targets(kWidth, kHeight, kAllFeatures);
    for (const GlTexture* texture : {&targets.hit, &targets.normal}) {
        glClearTexImage(texture->name(), 0, GL_RGBA, GL_FLOAT, nullptr);
    }
    for (const GlTexture* texture : {&targets.node, &targets.steps}) {
        glClearTexImage(texture->name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
    }
    const glm::vec4 hit(511.9375F, 0.1F, 65535, 123456.78F);
    const uint32_t node = 4711;
    const uint32_t steps = 0x80000000u | 77;
    const glm::vec4 normal(0.6F, -0.8F, 0.1F, 0);
    mark(targets.hit, GL_RGBA, GL_FLOAT, &hit);
    mark(targets.node, GL_RED_INTEGER, GL_UNSIGNED_INT, &node);
    mark(targets.steps, GL_RED_INTEGER, GL_UNSIGNED_INT, &steps);
    mark(targets.normal, GL_RGBA, GL_FLOAT, &normal);
    expectOneMark(targets.readHits(), hit, glm::vec4(0));
    expectOneMark(targets.readNodes(), node, 0u);
    expectOneMark(targets.readSteps(), steps, 0u);
    expectOneMark(targets.readNormals(), glm::vec3(normal), glm::vec3(0));
}

TEST_F(FrameTargetsTest, FramebuffersDrawIntoTheirTextures) {
    FrameTargets targets(kWidth, kHeight, kAllFeatures);
    const RasterTargets& raster = targets.raster(true);
    const std::array<GLuint, 4> id = {7, 0, 0, 0};
    const std::array<GLuint, 4> node = {8, 0, 0, 0};
    const std::array<GLfloat, 4> hit = {1, 2, 3, 4};
    const std::array<GLfloat, 4> colour = {1, 0, 0, 1};
    const std::array<GLfloat, 4> normal = {0, 0, 1, 0};
    const GLfloat depth = 0.5F;
    glClearNamedFramebufferuiv(raster.idFramebuffer.name(), GL_COLOR, 0, id.data());
    glClearNamedFramebufferfv(raster.marchFramebuffer.name(), GL_COLOR, 0, hit.data());
    glClearNamedFramebufferuiv(raster.marchFramebuffer.name(), GL_COLOR, 1, node.data());
    glClearNamedFramebufferfv(raster.marchFramebuffer.name(), GL_DEPTH, 0, &depth);
    glClearNamedFramebufferfv(raster.resolveFramebuffer.name(), GL_COLOR, 0, colour.data());
    glClearNamedFramebufferfv(raster.resolveFramebuffer.name(), GL_COLOR, 1, normal.data());
    uint32_t readId = 0;
    glGetTextureSubImage(raster.id.name(), 0, 3, 3, 0, 1, 1, 1, GL_RED_INTEGER, GL_UNSIGNED_INT, 4, &readId);
    float readDepth = 0;  // written by the march's framebuffer, tested by the ID pass's
    glGetTextureSubImage(raster.depth.name(), 0, 3, 3, 0, 1, 1, 1, GL_DEPTH_COMPONENT, GL_FLOAT, 4, &readDepth);
    GLint idPassDepth = 0;
    glGetNamedFramebufferAttachmentParameteriv(raster.idFramebuffer.name(), GL_DEPTH_ATTACHMENT,
                                               GL_FRAMEBUFFER_ATTACHMENT_OBJECT_NAME, &idPassDepth);
    EXPECT_EQ(readId, 7u);
    EXPECT_EQ(readDepth, depth);
    EXPECT_EQ(static_cast<GLuint>(idPassDepth), raster.depth.name());
    EXPECT_EQ(targets.readHits().at(3, 3), glm::vec4(1, 2, 3, 4));
    EXPECT_EQ(targets.readNodes().at(3, 3), 8u);
    EXPECT_EQ(targets.readSrgb().at(3, 3), (std::array<uint8_t, 4>{255, 0, 0, 255}));
    EXPECT_EQ(targets.readNormals().at(3, 3), glm::vec3(0, 0, 1));
}

TEST_F(FrameTargetsTest, WhatIsOffIsNotAllocated) {
    FrameTargets plain(kWidth, kHeight, {});
    EXPECT_FALSE(plain.steps);
    EXPECT_FALSE(plain.normal);
    const FrameTargets all(kWidth, kHeight, kAllFeatures);
    EXPECT_TRUE(all.steps);
    EXPECT_TRUE(all.normal);
    // hit 16, node 4, colour 4 bytes a pixel; steps 4 and normals 16 more
    EXPECT_EQ(plain.bytes(), uint64_t{kWidth * kHeight * 24});
    EXPECT_EQ(all.bytes(), uint64_t{kWidth * kHeight * 44});
}

TEST_F(FrameTargetsTest, DepthAndIdsExistForTheRasterLaunchAlone) {
    FrameTargets targets(kWidth, kHeight, {});
    EXPECT_TRUE(targets.raster(true).id);
    EXPECT_EQ(targets.bytes(), uint64_t{kWidth * kHeight * 32});
    EXPECT_FALSE(targets.raster(false).id);
    EXPECT_EQ(targets.bytes(), uint64_t{kWidth * kHeight * 28});
    targets.dropRaster();
    EXPECT_EQ(targets.bytes(), uint64_t{kWidth * kHeight * 24});
}

TEST_F(FrameTargetsTest, OnePixelIsAPicture) {
    const FrameTargets targets(1, 1, kAllFeatures);
    EXPECT_EQ(targets.readSrgb().size(), (GridSize{1, 1}));
}

TEST_F(FrameTargetsTest, AskingForWhatIsOffIsMisuse) {
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
    EXPECT_DEATH((void)FrameTargets(1, 1, {}).readSteps(), "check failed");
    EXPECT_DEATH((void)FrameTargets(1, 1, {}).readNormals(), "check failed");
    EXPECT_DEATH((void)FrameTargets(1, 1, {}).readLinear(), "check failed");
    EXPECT_DEATH((void)FrameTargets(1, 1, {}, ColourFormat::linearFloat).readSrgb(), "check failed");
}

}  // namespace
}  // namespace terray
