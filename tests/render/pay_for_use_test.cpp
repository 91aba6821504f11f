// What is switched off is not in the program: the samplers and images that a compiled program has, as GL itself lists
// them.

#include <array>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "client/render/feature_set.h"
#include "client/render/gpu_tiles.h"
#include "client/render/shader_library.h"
#include "tests/render/gl_test.h"
#include "tests/render/preprocessed.h"

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

/// Names of the buffers that a program reads, uniform ones and others.
Names buffersOf(const GlProgram& program) {
    Names names;
    for (const GLenum kind : {GL_UNIFORM_BLOCK, GL_SHADER_STORAGE_BLOCK}) {
        GLint count = 0;
        glGetProgramInterfaceiv(program.name(), kind, GL_ACTIVE_RESOURCES, &count);
        for (GLint i = 0; i < count; ++i) {
            std::array<char, 64> name{};
            glGetProgramResourceName(program.name(), kind, static_cast<GLuint>(i), name.size(), nullptr, name.data());
            names.insert(name.data());
        }
    }
    return names;
}

class PayForUse : public GlTest {
  protected:
    Names uniforms(const std::vector<std::string>& stages, const FeatureSet& features) {
        return uniformsOf(shaders_.require(stages, features.defines()));
    }
    ShaderLibrary shaders_;
};

TEST_F(PayForUse, TheMarchAloneReadsHeightsAndNothingElse) {
    EXPECT_EQ(uniforms({"box.vert", "march.frag"}, {}), (Names{"heightCodes", "nodeIndex"}));
    EXPECT_EQ(uniforms({"march.comp"}, {}), (Names{"heightCodes", "hitImage", "nodeCount", "nodeImage"}));
}

TEST_F(PayForUse, EachFeatureOfTheMarchAddsItsOwnTexture) {
    EXPECT_EQ(uniforms({"box.vert", "march.frag"}, {.occlusion = true}),
              (Names{"heightCodes", "nodeIndex", "nodeInFront"}));
    EXPECT_EQ(uniforms({"box.vert", "march.frag"}, {.statistics = true}),
              (Names{"heightCodes", "nodeIndex", "stepImage"}));
    EXPECT_EQ(uniforms({"march.comp"}, {.statistics = true}),
              (Names{"heightCodes", "hitImage", "nodeCount", "nodeImage", "stepImage"}));
}

TEST_F(PayForUse, PhotosAreReadOnlyWithImagery) {
    const Names bare = {"heightCodes", "hits", "hitNodes"};
    Names withPhotos = bare;
    withPhotos.insert("photos");
    EXPECT_EQ(uniforms({"screen.vert", "resolve.frag"}, {}), bare);
    EXPECT_EQ(uniforms({"screen.vert", "resolve.frag"}, {.photoProbes = true}), bare);
    EXPECT_EQ(uniforms({"screen.vert", "resolve.frag"}, {.imagery = true}), withPhotos);
    EXPECT_EQ(uniforms({"screen.vert", "resolve.frag"}, {.imagery = true, .photoProbes = true}), withPhotos);
}

TEST_F(PayForUse, SkyAndAirAreReadOnlyWhenTheyAreOn) {
    const Names bare = {"heightCodes", "hits", "hitNodes"};
    const Names frame = {"FrameBuffer", "NodeBuffer"};
    const auto with = [](Names names, const char* name) {
        names.insert(name);
        return names;
    };
    for (const std::vector<std::string>& stages :
         {std::vector<std::string>{"screen.vert", "resolve.frag"}, std::vector<std::string>{"resolve.comp"}}) {
        const auto program = [&](const FeatureSet& features) { return shaders_.require(stages, features.defines()); };
        Names own = uniformsOf(program({}));
        own.erase("colourImage");  // of the compute launch
        EXPECT_EQ(own, bare);
        EXPECT_EQ(buffersOf(program({})), frame);
        // Air alone is arithmetic; the sky has a table, and both together one of air by distance.
        EXPECT_EQ(uniformsOf(program({.air = true})), uniformsOf(program({})));
        EXPECT_EQ(buffersOf(program({.air = true})), frame);
        EXPECT_EQ(uniformsOf(program({.sky = true})), with(uniformsOf(program({})), "skyTable"));
        EXPECT_EQ(buffersOf(program({.sky = true})), with(frame, "SkyBuffer"));
        EXPECT_EQ(uniformsOf(program({.sky = true, .air = true})),
                  with(with(uniformsOf(program({})), "skyTable"), "airTable"));
    }
}

TEST_F(PayForUse, OverlaysReadHitsAndWhatTheirMeshIs) {
    const Names own = {"colour", "growth", "hitNodes", "hits", "origin"};
    const auto overlay = [&](const FeatureSet& features) {
        return uniforms({"overlay.vert", "overlay.frag"}, features);
    };
    EXPECT_EQ(overlay({}), own);
    EXPECT_EQ(overlay({.linearColour = true, .curved = true}), own);
    EXPECT_EQ(overlay({.air = true}), own);
    EXPECT_EQ(overlay({.sky = true}), own) << "the light comes from a buffer";
    Names throughAir = own;
    throughAir.insert("airTable");
    EXPECT_EQ(overlay({.sky = true, .air = true}), throughAir);
}

TEST_F(PayForUse, ThePyramidsProgramIsWhatItIsWhereNoOtherMethodExists) {
    const ShaderFolder without(ShaderFiles{{"method.glsl", "#include \"march.glsl\"\n"}});
    const ShaderLibrary bare(without.path());
    for (const char* root : {"march.frag", "march.comp"})
        for (const Method method : {Method::pyramid, Method::march}) {
            const FeatureSet all{
                .statistics = true, .occlusion = true, .bilinear = true, .curved = true, .method = method};
            const ShaderDefines defines = all.marching().defines();
            const std::string code = preprocessed(shaders_.resolve(root, defines).value().text);
            EXPECT_EQ(code, preprocessed(bare.resolve(root, defines).value().text)) << root;
            EXPECT_NE(code.find("levelAfter("), std::string::npos) << "the preprocessor lost the program";
            for (const char* part : {"groundCode", "MethodBuffer", "halved"})
                EXPECT_EQ(code.find(part), std::string::npos) << root << " holds " << part;
        }
}

TEST_F(PayForUse, AMethodReadsHeightsAndWhatItSearchesBy) {
    for (const std::vector<std::string>& stages :
         {std::vector<std::string>{"box.vert", "march.frag"}, std::vector<std::string>{"march.comp"}})
        for (const bool bilinear : {false, true})
            for (const bool curved : {false, true}) {
                const FeatureSet pyramid{.bilinear = bilinear, .curved = curved};
                FeatureSet linear = pyramid;
                linear.method = Method::linear;
                const GlProgram program = shaders_.require(stages, linear.defines());
                EXPECT_EQ(uniformsOf(program), uniforms(stages, pyramid));
                Names buffers = buffersOf(shaders_.require(stages, pyramid.defines()));
                buffers.insert("MethodBuffer");
                EXPECT_EQ(buffersOf(program), buffers);
            }
}

TEST_F(PayForUse, OnlyTheMethodThatIsChosenKeepsSomethingOfTiles) {
    // Of the others neither a buffer nor a texture exists.
    for (const MethodEntry& entry : kMethods) {
        const bool keeps = entry.geometry || entry.method == Method::cones;
        GpuTiles tiles(shaders_, {.heightTiles = 2, .method = {.method = {.method = entry.method}}});
        EXPECT_EQ(tiles.methodTiles() != nullptr, keeps) << entry.name;
        HeightTile tile;
        tile.codes = Grid<uint16_t>({kHeightTileSide, kHeightTileSide}, uint16_t{100});
        EXPECT_TRUE(tiles.uploadHeights(tile).done);
        // What the hybrid keeps of a tile is made when it is first drawn so.
        EXPECT_EQ(tiles.allocatedBytes().method > 0, keeps && entry.method != Method::hybrid) << entry.name;
    }
}

TEST_F(PayForUse, AMethodsShadersAreThoseItNamesAndNoOthers) {
    struct Part {
        Method method;
        const char* text;  ///< that its own module alone holds
    };
    constexpr Part kParts[] = {{Method::linear, "method.linear"}, {Method::cones, "sampler2DArray cones"}};
    for (const char* root : {"march.frag", "march.comp"})
        for (const MethodEntry& entry : kMethods) {
            const ShaderDefines defines = FeatureSet{.method = entry.method}.marching().defines();
            const std::string code = preprocessed(shaders_.resolve(root, defines).value().text);
            for (const Part& part : kParts)
                EXPECT_EQ(code.find(part.text) != std::string::npos, part.method == entry.method)
                    << root << " of " << entry.name << ": " << part.text;
        }
}

const std::vector<std::vector<std::string>> kResolvePrograms = {{"screen.vert", "resolve.frag"}, {"resolve.comp"}};

TEST_F(PayForUse, ThePhotosProgramIsWhatItIsWhereNoShadingModeExists) {
    const ShaderFolder without(ShaderFiles{{"shading.glsl", ""}});
    const ShaderLibrary bare(without.path());
    for (const char* root : {"resolve.frag", "resolve.comp"})
        for (const FeatureSet& features :
             {FeatureSet{}, FeatureSet{.imagery = true, .photoProbes = true}, FeatureSet{.shading = Shading::light},
              FeatureSet{
                  .imagery = true, .normals = true, .curved = true, .sky = true, .air = true, .shadows = true}}) {
            const ShaderDefines defines = features.resolving().defines();
            const std::string code = preprocessed(shaders_.resolve(root, defines).value().text);
            EXPECT_EQ(code, preprocessed(bare.resolve(root, defines).value().text)) << root;
            EXPECT_NE(code.find("vec3 groundColour("), std::string::npos) << "the preprocessor lost the program";
            for (const char* part : {"legendColour", "linearFromSrgb", "ShadingBuffer", "stepColour", "lineCover"})
                EXPECT_EQ(code.find(part), std::string::npos) << root << " holds " << part;
        }
}

TEST_F(PayForUse, AShadingModeReadsNothingButItsOwn) {
    for (const auto& stages : kResolvePrograms) {
        const auto program = [&](const FeatureSet& features) { return shaders_.require(stages, features.defines()); };
        const Names bare = uniformsOf(program({}));
        for (const ShadingMode& mode : kShadingModes) {
            // Neither photo nor probes are on for any of them but those that show the photo.
            const FeatureSet features = FeatureSet{.imagery = mode.shading != Shading::photo,
                                                   .curved = true,
                                                   .shadows = mode.shading == Shading::shadowSteps,
                                                   .shading = mode.shading}
                                            .resolving();
            const ShadingNeeds needs = needsOf(mode.shading);
            Names buffers = {"FrameBuffer", "NodeBuffer"};
            if (needs.measures) buffers.insert("ShadingBuffer");
            Names expected = bare;
            if (needs.photo && features.imagery) expected.insert("photos");
            if (needs.steps || needs.shadowSteps) {
                expected.insert("stepCounts");
                for (const char* ground : {"heightCodes", "hitNodes", "hits"}) expected.erase(ground);
            }
            if (mode.shading == Shading::depth) expected.erase("heightCodes");
            const GlProgram made = program(features);
            EXPECT_EQ(uniformsOf(made), expected) << mode.name;
            EXPECT_EQ(buffersOf(made), buffers) << mode.name;
        }
    }
}

TEST_F(PayForUse, EveryShadingModeCompilesBesideEveryOtherFeature) {
    for (const ShadingMode& mode : kShadingModes)
        for (int bits = 0; bits < 1 << 6; ++bits) {
            const FeatureSet features{.normals = (bits & 1) != 0,
                                      .linearColour = (bits & 2) != 0,
                                      .curved = (bits & 4) != 0,
                                      .sky = (bits & 8) != 0,
                                      .air = (bits & 16) != 0,
                                      .shadows = (bits & 32) != 0,
                                      .shading = mode.shading};
            if (features != features.resolving()) continue;
            for (const auto& stages : kResolvePrograms) EXPECT_TRUE(shaders_.require(stages, features.defines()));
        }
}

TEST_F(PayForUse, EveryCombinationOfFeaturesCompiles) {
    for (int bits = 0; bits < 1 << 11; ++bits) {
        FeatureSet features{.imagery = (bits & 1) != 0,
                            .statistics = (bits & 2) != 0,
                            .normals = (bits & 4) != 0,
                            .signalSky = (bits & 8) != 0,
                            .linearColour = (bits & 16) != 0,
                            .occlusion = (bits & 32) != 0,
                            .photoProbes = (bits & 64) != 0,
                            .bilinear = (bits & 128) != 0,
                            .curved = (bits & 256) != 0,
                            .sky = (bits & 512) != 0,
                            .air = (bits & 1024) != 0};
        // What a program does not depend on makes no new program.
        if (features == features.marching()) {
            EXPECT_FALSE(uniforms({"box.vert", "march.frag"}, features).empty());
            features.occlusion = false;
            EXPECT_FALSE(uniforms({"march.comp"}, features).empty());
        }
        if (features == features.resolving()) {
            EXPECT_FALSE(uniforms({"screen.vert", "resolve.frag"}, features).empty());
            EXPECT_FALSE(uniforms({"resolve.comp"}, features).empty());
        }
        if (features == features.overlaying()) {
            EXPECT_FALSE(uniforms({"overlay.vert", "overlay.frag"}, features).empty());
        }
    }
}

}  // namespace
}  // namespace terray
