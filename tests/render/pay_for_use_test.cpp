// What is switched off is not in the program: the samplers and images that a compiled program has, as GL itself lists
// them.

#include <array>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "client/render/feature_set.h"
#include "client/render/shader_library.h"
#include "tests/render/gl_test.h"

namespace terray {
namespace {

/// Names of the active uniforms outside blocks: samplers, images and plain ones.
std::set<std::string> uniformsOf(const GlProgram& program) {
    std::set<std::string> names;
    GLint count = 0;
    glGetProgramInterfaceiv(program.name(), GL_UNIFORM, GL_ACTIVE_RESOURCES, &count);
    for (GLint i = 0; i < count; ++i) {
        const GLenum property = GL_BLOCK_INDEX;
        GLint block = -1;
        glGetProgramResourceiv(program.name(), GL_UNIFORM, static_cast<GLuint>(i), 1, &property, 1, nullptr, &block);
        if (block != -1) continue;
        std::array<char, 64> name{};
        glGetProgramResourceName(program.name(), GL_UNIFORM, static_cast<GLuint>(i), name.size(), nullptr, name.data());
        names.insert(name.data());
    }
    return names;
}

using Names = std::set<std::string>;

class PayForUse : public GlTest {
  protected:
    Names uniforms(const std::vector<std::string>& stages, const FeatureSet& features, bool occlusion = false,
                   bool probes = false) {
        ShaderDefines defines = features.defines();
        defines["TERRAY_OCCLUSION"] = occlusion ? "1" : "0";
        defines["TERRAY_PHOTO_PROBES"] = probes ? "1" : "0";
        return uniformsOf(shaders_.require(stages, defines));
    }
    ShaderLibrary shaders_;
};

TEST_F(PayForUse, TheMarchAloneReadsHeightsAndNothingElse) {
    EXPECT_EQ(uniforms({"box.vert", "march.frag"}, {}), (Names{"heightCodes", "nodeIndex"}));
}

TEST_F(PayForUse, EachFeatureOfTheMarchAddsItsOwnTexture) {
    EXPECT_EQ(uniforms({"box.vert", "march.frag"}, {}, true), (Names{"heightCodes", "nodeIndex", "nodeInFront"}));
    EXPECT_EQ(uniforms({"box.vert", "march.frag"}, {.statistics = true}),
              (Names{"heightCodes", "nodeIndex", "stepImage"}));
}

TEST_F(PayForUse, PhotosAreReadOnlyWithImagery) {
    const Names bare = {"heightCodes", "hits", "hitNodes"};
    Names withPhotos = bare;
    withPhotos.insert("photos");
    EXPECT_EQ(uniforms({"screen.vert", "resolve.frag"}, {}), bare);
    EXPECT_EQ(uniforms({"screen.vert", "resolve.frag"}, {}, false, true), bare);
    EXPECT_EQ(uniforms({"screen.vert", "resolve.frag"}, {.imagery = true}), withPhotos);
    EXPECT_EQ(uniforms({"screen.vert", "resolve.frag"}, {.imagery = true}, false, true), withPhotos);
}

TEST_F(PayForUse, EveryCombinationOfFeaturesCompiles) {
    for (int bits = 0; bits < 64; ++bits) {
        const FeatureSet features{.imagery = (bits & 1) != 0,
                                  .statistics = (bits & 2) != 0,
                                  .normals = (bits & 4) != 0,
                                  .signalSky = (bits & 8) != 0};
        const bool occlusion = (bits & 16) != 0;
        const bool probes = (bits & 32) != 0;
        EXPECT_FALSE(uniforms({"box.vert", "march.frag"}, features, occlusion, probes).empty());
        EXPECT_FALSE(uniforms({"screen.vert", "resolve.frag"}, features, occlusion, probes).empty());
    }
}

}  // namespace
}  // namespace terray
