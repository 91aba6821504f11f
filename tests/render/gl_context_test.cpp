#include "client/render/gl_context.h"

#include <cstdlib>
#include <functional>
#include <iostream>
#include <thread>

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include "common/error.h"
#include "tests/render/gl_test.h"

namespace terray {
namespace {

/// Runs something in a child process that ends as a program would: status and message of the Error that it throws.
[[noreturn]] void exitAsProgram(const std::function<void()>& body) {
    try {
        body();
    } catch (const Error& error) {
        std::cerr << error.what() << std::endl;
        std::_Exit(static_cast<int>(error.code()));
    }
    std::_Exit(0);
}

/// Of GLVND, which dispatches EGL to its vendors: use this one only.
constexpr const char* kVendorVariable = "__EGL_VENDOR_LIBRARY_FILENAMES";
constexpr const char* kMesaVendor = "/usr/share/glvnd/egl_vendor.d/50_mesa.json";
const auto kGraphicsError = testing::ExitedWithCode(static_cast<int>(ExitCode::graphics));

TEST(HeadlessContext, IsOpenGl45CoreAndSaysHowItWasMade) {
    const HeadlessContext context;
    GLint major = 0;
    GLint minor = 0;
    GLint profile = 0;
    glGetIntegerv(GL_MAJOR_VERSION, &major);
    glGetIntegerv(GL_MINOR_VERSION, &minor);
    glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
    EXPECT_GE(major * 10 + minor, 45);
    EXPECT_EQ(profile, GL_CONTEXT_CORE_PROFILE_BIT);
    EXPECT_FALSE(context.strings().vendor.empty());
    EXPECT_FALSE(context.strings().renderer.empty());
    EXPECT_FALSE(context.strings().version.empty());
    EXPECT_TRUE(context.strings().platform == "EGL device" || context.strings().platform == "EGL surfaceless")
        << context.strings().platform;
}

TEST(HeadlessContext, HasWhatTheRendererNeeds) {
    const HeadlessContext context;
    EXPECT_NO_THROW(requireRendererFeatures());
}

TEST(HeadlessContext, CanBeMadeAgainAfterItsEnd) {
    for (int i = 0; i < 3; ++i) {
        const HeadlessContext context;
        EXPECT_NE(glGetString(GL_VERSION), nullptr);
    }
}

TEST(HeadlessContext, OneThreadsEndLeavesTheOthersContextAlone) {
    const HeadlessContext context({.debug = true});
    std::string otherRenderer;
    std::thread([&] {
        const HeadlessContext other;
        otherRenderer = other.strings().renderer;
    }).join();
    EXPECT_EQ(otherRenderer, context.strings().renderer);
    GLuint texture = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    EXPECT_NE(texture, 0u);
    glDeleteTextures(1, &texture);
}

TEST(HeadlessContext, CollectsErrorsUntilTheyAreTaken) {
    HeadlessContext context({.debug = true});
    EXPECT_EQ(context.takeDebugMessages(), "");
    glEnable(GL_TEXTURE_2D_ARRAY);  // nothing that can be enabled
    EXPECT_NE(context.takeDebugMessages(), "");
    EXPECT_EQ(context.takeDebugMessages(), "");
}

TEST(HeadlessContextDeathTest, WithoutAnyDriverSaysSo) {
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
    const auto attempt = [] {
        setenv(kVendorVariable, "/nonexistent.json", 1);
        exitAsProgram([] { const HeadlessContext context; });
    };
    EXPECT_EXIT(attempt(), kGraphicsError,
                "cannot make an OpenGL 4.5 context without a window:\n  EGL has no driver, or none .*\n"
                "install a driver with EGL and OpenGL 4.5");
}

TEST(HeadlessContextDeathTest, WithAnOlderOpenGlListsWhatWasTried) {
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
    const auto attempt = [] {
        setenv(kVendorVariable, kMesaVendor, 1);
        setenv("MESA_GL_VERSION_OVERRIDE", "3.3", 1);
        exitAsProgram([] { const HeadlessContext context; });
    };
    EXPECT_EXIT(attempt(), kGraphicsError,
                "EGL device [0-9]+ .*: eglCreateContext \\(OpenGL 4.5 core\\): EGL_BAD_MATCH\n"
                "  EGL surfaceless: eglCreateContext \\(OpenGL 4.5 core\\): EGL_BAD_MATCH\n"
                "install a driver with EGL and OpenGL 4.5");
}

TEST(RendererFeaturesDeathTest, NameEverythingThatIsMissing) {
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
    const auto attempt = [] {
        setenv(kVendorVariable, kMesaVendor, 1);
        setenv("MESA_EXTENSION_OVERRIDE",
               "-GL_EXT_texture_compression_s3tc -GL_EXT_texture_filter_anisotropic -GL_ARB_texture_filter_anisotropic",
               1);
        exitAsProgram([] {
            const HeadlessContext context;
            requireRendererFeatures();
        });
    };
    EXPECT_EXIT(attempt(), kGraphicsError,
                "cannot draw with \".+\" \\(.+\\); it lacks:\n  S3TC textures \\(.*\n"
                "  anisotropic filtering.*\nupdate its driver");
}

}  // namespace
}  // namespace terray
