#include "tests/render/gl_test.h"

#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include <epoxy/gl.h>

namespace terray {

void GlTest::TearDown() {
    EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
    EXPECT_EQ(context_.takeDebugMessages(), "");
}

ShaderFolder::ShaderFolder(const ShaderFiles& files) {
    std::string name = (std::filesystem::temp_directory_path() / "terray-shaders-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make " + name);
    path_ = name;
    for (const auto& [file, text] : files) write(file, text);
}

ShaderFolder::~ShaderFolder() {
    std::error_code ignored;  // a left-over temporary folder is no reason to fail
    std::filesystem::remove_all(path_, ignored);
}

void ShaderFolder::write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << text;
}

}  // namespace terray
