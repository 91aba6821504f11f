#include "client/render/shader_library.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "client/render/embedded_shaders.h"
#include "common/error.h"
#include "tests/render/gl_test.h"

namespace terray {
namespace {

using ShaderCompilation = GlTest;

size_t occurrences(const std::string& text, const std::string& part) {
    size_t count = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
    return count;
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// Why a shader of some files cannot be resolved.
std::string resolveFailure(const ShaderFiles& files, const std::string& name) {
    const ShaderFolder folder(files);
    const auto resolved = ShaderLibrary(folder.path()).resolve(name, {});
    return resolved.ok() ? "" : resolved.failure().message;
}

/// Files 0.glsl .. <depth>.glsl, each including the next one; 0 is the root.
ShaderFiles nested(int depth) {
    ShaderFiles files;
    for (int i = 0; i < depth; ++i) {
        files[std::to_string(i) + ".glsl"] = "#include \"" + std::to_string(i + 1) + ".glsl\"\n";
    }
    files[std::to_string(depth) + ".glsl"] = "deepest\n";
    return files;
}

TEST(ShaderLibrary, HoldsEveryShaderAsItIsInTheSources) {
    const std::filesystem::path folder = TERRAY_SHADER_FOLDER;
    size_t found = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        const std::string name = std::filesystem::relative(entry.path(), folder).generic_string();
        const std::string ending = entry.path().extension().string();
        const bool shader = ending == ".vert" || ending == ".frag" || ending == ".comp" || ending == ".glsl";
        if (!shader && name != "interop.h") continue;
        ++found;
        std::ifstream file(entry.path(), std::ios::binary);
        const std::string text(std::istreambuf_iterator<char>(file), {});
        const auto embedded = std::ranges::find(embeddedShaders(), name, &EmbeddedShader::name);
        ASSERT_NE(embedded, embeddedShaders().end()) << name;
        EXPECT_TRUE(embedded->text == text) << name;
    }
    EXPECT_EQ(found, embeddedShaders().size());
    EXPECT_GT(found, 0u);
}

TEST(ShaderLibrary, BeginsWithVersionThenDefinesByNameThenTheSource) {
    const ShaderFolder folder(ShaderFiles{{"a.frag", "first\nsecond\n"}});
    const auto resolved = ShaderLibrary(folder.path()).resolve("a.frag", {{"TERRAY_B", "0"}, {"TERRAY_A", "17"}});
    ASSERT_TRUE(resolved.ok()) << resolved.failure().message;
    EXPECT_EQ(resolved->text, "#version 450 core\n#define TERRAY_A 17\n#define TERRAY_B 0\nfirst\nsecond\n");
    EXPECT_EQ(resolved->files, std::vector<std::string>{"a.frag"});
}

TEST(ShaderLibrary, IncludesEachFileOnceAndRemembersEachLinesOrigin) {
    const ShaderFolder folder(
        ShaderFiles{{"a.frag", "#include \"b.glsl\"\n  # include \"math/c.glsl\"  // again\nmain\n"},
                    {"b.glsl", "before\n#include \"math/c.glsl\"\nafter\n"},
                    {"math/c.glsl", "common"}});  // no end of line
    const auto resolved = ShaderLibrary(folder.path()).resolve("a.frag", {});
    ASSERT_TRUE(resolved.ok()) << resolved.failure().message;
    EXPECT_EQ(resolved->files, (std::vector<std::string>{"a.frag", "b.glsl", "math/c.glsl"}));
    EXPECT_EQ(resolved->text, "#version 450 core\nbefore\ncommon\nafter\nmain\n");
    std::string origins;
    for (const auto& [file, line] : resolved->origins) {
        origins += resolved->files[file] + ":" + std::to_string(line) + " ";
    }
    EXPECT_EQ(origins, "a.frag:0 b.glsl:1 math/c.glsl:1 b.glsl:3 a.frag:3 ");
}

TEST(ShaderLibrary, IncludesAgainWhatOnlyAFeatureIncludedBefore) {
    const ShaderFolder folder(
        ShaderFiles{{"a.frag", "#if TERRAY_X\n#include \"b.glsl\"\n#endif\n#include \"b.glsl\"\n#include \"b.glsl\"\n"},
                    {"b.glsl", "#ifndef B\n#define B\n#include \"c.glsl\"\n#endif\n"},
                    {"c.glsl", "common\n"}});
    const auto resolved = ShaderLibrary(folder.path()).resolve("a.frag", {});
    ASSERT_TRUE(resolved.ok()) << resolved.failure().message;
    EXPECT_EQ(occurrences(resolved->text, "common"), 2u);
    EXPECT_EQ(resolved->files, (std::vector<std::string>{"a.frag", "b.glsl", "c.glsl"}));
}

TEST(ShaderLibrary, TakesTheNameFromTheRepositorysRootForTheSameFile) {
    const ShaderFolder folder(
        ShaderFiles{{"a.frag", "#include \"shaders/c.glsl\"\n#include \"c.glsl\"\n"}, {"c.glsl", "common\n"}});
    const auto resolved = ShaderLibrary(folder.path()).resolve("a.frag", {});
    ASSERT_TRUE(resolved.ok()) << resolved.failure().message;
    EXPECT_EQ(occurrences(resolved->text, "common"), 1u);
}

TEST(ShaderLibrary, SkipsHeadersOfCpp) {
    const ShaderFolder folder(ShaderFiles{{"a.frag", "#include <cstdint>\nmain\n"}});
    const auto resolved = ShaderLibrary(folder.path()).resolve("a.frag", {});
    ASSERT_TRUE(resolved.ok()) << resolved.failure().message;
    EXPECT_FALSE(contains(resolved->text, "cstdint"));
    EXPECT_EQ(resolved->origins.back().line, 2);
}

TEST(ShaderLibrary, RefusesACycleAndNamesWhoClosesIt) {
    EXPECT_EQ(resolveFailure({{"a.frag", "#include \"b.glsl\"\n"}, {"b.glsl", "\n\n#include \"a.frag\"\n"}}, "a.frag"),
              "shaders/b.glsl:3: cannot include \"a.frag\": it includes this file (a cycle)");
    EXPECT_EQ(resolveFailure({{"a.frag", "#include \"a.frag\"\n"}}, "a.frag"),
              "shaders/a.frag:1: cannot include \"a.frag\": it includes this file (a cycle)");
}

TEST(ShaderLibrary, RefusesAMissingFileAndNamesWhoAsked) {
    const std::string failure =
        resolveFailure({{"a.frag", "#include \"b.glsl\"\n"}, {"b.glsl", "\n#include \"none.glsl\"\n"}}, "a.frag");
    EXPECT_TRUE(
        failure.starts_with("shaders/b.glsl:2: cannot include \"none.glsl\": there is no shaders/none.glsl in "))
        << failure;
    EXPECT_TRUE(contains(resolveFailure({}, "none.frag"), "there is no shaders/none.frag"));
}

TEST(ShaderLibrary, RefusesNamesThatAreNotPlain) {
    for (const std::string name : {"../secret.glsl", "/etc/passwd", "math/../b.glsl", "./b.glsl"}) {
        const std::string failure =
            resolveFailure({{"a.frag", "#include \"" + name + "\"\n"}, {"b.glsl", ""}}, "a.frag");
        EXPECT_TRUE(contains(failure, "is not a plain name relative to shaders/")) << name << ": " << failure;
    }
}

TEST(ShaderLibrary, AllowsSixteenFilesWithinEachOtherAndNoMore) {
    EXPECT_EQ(resolveFailure(nested(16), "0.glsl"), "");
    EXPECT_EQ(resolveFailure(nested(17), "0.glsl"),
              "shaders/16.glsl:1: cannot include \"17.glsl\": more than 16 files within each other");
}

TEST(ShaderLibrary, PrefersTheGivenFolderAndSeesItsEdits) {
    const std::string name(embeddedShaders().front().name);
    const ShaderFolder folder(ShaderFiles{{name, "mine\n"}});
    const ShaderLibrary library(folder.path());
    EXPECT_TRUE(contains(library.resolve(name, {})->text, "mine\n"));
    folder.write(name, "edited\n");
    EXPECT_TRUE(contains(library.resolve(name, {})->text, "edited\n"));
    EXPECT_TRUE(library.resolve("maxima.comp", {}).ok());  // not in the folder
}

/// Line 2 of the text is line 41 of an included file.
ResolvedShader shaderForLogs() {
    return {.text = "#version 450 core\n    int x = nowhere;\n",
            .files = {"march.frag", "math/box.glsl"},
            .origins = {{0, 0}, {1, 41}}};
}

TEST(ShaderLog, IsMappedFromTheFormatsOfThreeVendors) {
    const std::string line = "    int x = nowhere;\n";
    EXPECT_EQ(mapShaderLog("0:2(5): error: `nowhere' undeclared\n", shaderForLogs()),
              "shaders/math/box.glsl:41: error: `nowhere' undeclared\n" + line);
    EXPECT_EQ(mapShaderLog("0(2) : error C1503: undefined variable \"nowhere\"\n", shaderForLogs()),
              "shaders/math/box.glsl:41: error C1503: undefined variable \"nowhere\"\n" + line);
    EXPECT_EQ(mapShaderLog("ERROR: 0:2: 'nowhere' : undeclared identifier\nWARNING: 0:2: slow\n", shaderForLogs()),
              "shaders/math/box.glsl:41: error: 'nowhere' : undeclared identifier\n" + line +
                  "shaders/math/box.glsl:41: warning: slow\n" + line);
}

TEST(ShaderLog, KeepsWhatItDoesNotUnderstand) {
    for (const std::string line :
         {"2 compilation errors. No code generated.", "0:3(5): error: there is no line 3", "0:0(0): error: no line 0",
          "0:99999999999999999999(1): error: absurd", "99999999999999999999(99999999999999999999) : error"}) {
        EXPECT_EQ(mapShaderLog(line, shaderForLogs()), line + "\n");
    }
    EXPECT_EQ(mapShaderLog("", shaderForLogs()), "");
    EXPECT_EQ(mapShaderLog(std::string_view("\0", 1), shaderForLogs()), "");
}

constexpr const char* kVertexShader = "void main() { gl_Position = vec4(0.0); }\n";

TEST_F(ShaderCompilation, BuildsAProgramFromStagesAndDefines) {
    const ShaderFolder folder(ShaderFiles{{"a.vert", kVertexShader},
                                          {"a.frag",
                                           "#include \"b.glsl\"\n"
                                           "layout(location = 0) out vec4 colour;\n"
                                           "#if TERRAY_ON\nvoid main() { colour = b(); }\n#endif\n"},
                                          {"b.glsl", "vec4 b() { return vec4(1.0); }\n"}});
    const auto program = ShaderLibrary(folder.path()).build({"a.vert", "a.frag"}, {{"TERRAY_ON", "1"}});
    ASSERT_TRUE(program.ok()) << program.failure().message;
    EXPECT_TRUE(glIsProgram(program->name()));
}

TEST_F(ShaderCompilation, AnErrorInAnIncludedFileIsReportedThereWithItsLine) {
    const ShaderFolder folder(
        ShaderFiles{{"a.comp",
                     "layout(local_size_x = 1) in;\n"
                     "#include \"math/bad.glsl\"\n"
                     "void main() { bad(); }\n"},
                    {"math/bad.glsl", "// a mistake follows\nvoid bad() {\n    int x = nowhere;\n}\n"}});
    const auto program = ShaderLibrary(folder.path()).build({"a.comp"}, {{"TERRAY_A", "0"}, {"TERRAY_B", "1"}});
    ASSERT_FALSE(program.ok());
    const std::string& message = program.failure().message;
    EXPECT_TRUE(message.starts_with("cannot build the GPU program a.comp:\n")) << message;
    EXPECT_TRUE(contains(message, "shaders/math/bad.glsl:3: error")) << message;
    EXPECT_TRUE(contains(message, "nowhere")) << message;
    EXPECT_TRUE(contains(message, "\n    int x = nowhere;\n")) << message;
}

TEST_F(ShaderCompilation, AnErrorAfterAnIncludeIsReportedOnItsOwnLine) {
    const ShaderFolder folder(ShaderFiles{{"a.comp",
                                           "layout(local_size_x = 1) in;\n"
                                           "#include \"good.glsl\"\n"
                                           "#include \"good.glsl\"\n"
                                           "\n"
                                           "void main() { float x = nowhere; }\n"},
                                          {"good.glsl", "float good() {\n    return 1.0;\n}\n"}});
    const auto program = ShaderLibrary(folder.path()).build({"a.comp"}, {});
    ASSERT_FALSE(program.ok());
    EXPECT_TRUE(contains(program.failure().message, "shaders/a.comp:5: error")) << program.failure().message;
}

TEST_F(ShaderCompilation, AnErrorOfTheLinkerIsReported) {
    const ShaderFolder folder(
        ShaderFiles{{"a.vert", "layout(location = 0) out vec4 passed;\n" + std::string(kVertexShader)},
                    {"a.frag",
                     "layout(location = 0) flat in ivec2 passed;\n"
                     "layout(location = 0) out vec4 colour;\n"
                     "void main() { colour = vec4(passed, 0, 0); }\n"}});
    const auto program = ShaderLibrary(folder.path()).build({"a.vert", "a.frag"}, {});
    ASSERT_FALSE(program.ok());
    EXPECT_TRUE(program.failure().message.starts_with("cannot build the GPU program a.vert + a.frag:\n"));
    EXPECT_GT(program.failure().message.size(), std::string("cannot build the GPU program a.vert + a.frag:\n").size());
}

TEST_F(ShaderCompilation, WhatCannotBeBuiltButMustBeIsAnErrorOfGraphics) {
    try {
        (void)ShaderLibrary().require({"none.comp"}, {});
        FAIL() << "no such shader";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::graphics);
        EXPECT_TRUE(contains(error.what(), "there is no shaders/none.comp in this program")) << error.what();
    }
}

TEST_F(ShaderCompilation, AFileThatIsNoStageIsRefused) {
    const auto program = ShaderLibrary().build({"interop.h"}, {});
    ASSERT_FALSE(program.ok());
    EXPECT_TRUE(contains(program.failure().message, "is none of .vert, .frag, .comp"));
}

}  // namespace
}  // namespace terray
