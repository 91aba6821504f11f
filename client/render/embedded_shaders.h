#pragma once

#include <span>
#include <string_view>

namespace terray {

/// A file of shaders/ as it was when the program was built.
struct EmbeddedShader {
    std::string_view name;  ///< relative to shaders/, such as "math/box.glsl"
    std::string_view text;
};

/// Every shader file, sorted by name. The source is written by the build (shaders/embed.cmake).
[[nodiscard]] std::span<const EmbeddedShader> embeddedShaders();

}  // namespace terray
