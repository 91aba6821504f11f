#pragma once

#include <filesystem>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "client/render/gl_context.h"

namespace terray {

/// A test that draws: it has a debug context, and fails when none can be made or when the driver reports an error.
class GlTest : public testing::Test {
  protected:
    void TearDown() override;

    HeadlessContext context_{{.debug = true}};
};

/// Texts of shader files by their name.
using ShaderFiles = std::map<std::string, std::string>;

/// A folder of shader files for ShaderLibrary, removed with this object.
class ShaderFolder {
  public:
    explicit ShaderFolder(const ShaderFiles& files);
    ~ShaderFolder();
    ShaderFolder(const ShaderFolder&) = delete;
    ShaderFolder& operator=(const ShaderFolder&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    void write(const std::string& name, const std::string& text) const;

  private:
    std::filesystem::path path_;
};

}  // namespace terray
