// What drawing costs is measured once for a machine, kept in a file, and measured anew by other graphics.

#include "client/engine/draw_costs_file.h"

#include <fstream>

#include <gtest/gtest.h>

#include "client/render/gl_context.h"
#include "common/error.h"
#include "common/json.h"
#include "tests/common/temporary_directory.h"

namespace terray {
namespace {

class DrawCostsFile : public testing::Test {
  protected:
    HeadlessContext context_{HeadlessContext::Options{.debug = true}};
    ShaderLibrary shaders_;
    test::TemporaryDirectory folder_;
    std::filesystem::path file_ = folder_ / "costs.json";

    void TearDown() override { EXPECT_EQ(context_.takeDebugMessages(), ""); }
    [[nodiscard]] Json content() const {
        std::ifstream stream(file_);
        return Json::parse(std::string(std::istreambuf_iterator<char>(stream), {})).value();
    }
    void write(const std::string& text) const { std::ofstream(file_) << text; }
};

TEST_F(DrawCostsFile, IsWrittenOnceAndReadFromThenOn) {
    const DrawCosts measured = settledDrawCosts(file_, shaders_);
    EXPECT_GT(measured.castPixel + measured.castStep, 0);
    EXPECT_GT(measured.meshTriangle, 0);
    EXPECT_EQ(settledDrawCosts(file_, shaders_), measured) << "a second measurement would differ";
    Json changed = content();
    changed.set("mesh_node_ms", 0.125);
    write(changed.dump());
    EXPECT_EQ(settledDrawCosts(file_, shaders_).meshNode, 0.125);
    changed.set("version", 1);
    write(changed.dump());
    EXPECT_NE(settledDrawCosts(file_, shaders_).meshNode, 0.125) << "of a version that had fewer costs";
    changed = content();
    changed.set("mesh_node_ms", 0.125);
    changed.set("graphics", "another card");
    write(changed.dump());
    EXPECT_NE(settledDrawCosts(file_, shaders_).meshNode, 0.125);
    EXPECT_NE(content().stringAt("graphics").value(), "another card");
}

TEST_F(DrawCostsFile, IsRefusedWhenItIsSomethingElse) {
    for (const char* text : {"", "{", "{}", R"({"format":"terray-draw-costs","version":3})"}) {
        write(text);
        try {
            (void)settledDrawCosts(file_, shaders_);
            ADD_FAILURE() << text;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::input) << error.what();
        }
    }
}

}  // namespace
}  // namespace terray
