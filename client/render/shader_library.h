#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/render/gl_objects.h"
#include "common/result.h"

namespace terray {

/// A preprocessor define of a shader: always 0 or 1 for features, a number for constants; sorted by name when compiled.
using ShaderDefines = std::map<std::string, std::string>;

/// The text of one shader after its includes were resolved.
struct ResolvedShader {
    /// Where a line comes from.
    struct Origin {
        size_t file = 0;  ///< index into files
        int line = 0;     ///< from 1; 0: one of the lines put before the root, such as a define
    };
    std::string text;                ///< #version 450 core, then the defines, then the sources
    std::vector<std::string> files;  ///< in the order in which they were first included; files[0] is the root
    std::vector<Origin> origins;     ///< of each line of text
};

/// Shader sources by name relative to shaders/, such as "march.frag". Compiled into the program at build time; a
/// directory given at run time takes precedence (for work on shaders).
///
/// `#include "math/box.glsl"` is resolved relative to shaders/, each file once per shader; a cycle, a missing
/// file and depth over 16 are failures naming the file and line that asked. Written as "shaders/math/box.glsl", as C++
/// names it, it is the same file; includes in angle brackets are C++'s own and are skipped. Includes are resolved
/// before the preprocessor runs, so what was included inside #if does not count as done, and is put in again where the
/// next file asks for it; guards (#ifndef) keep it from being compiled twice. Compile
/// errors are reported as "shaders/math/box.glsl:41: <driver's message>" with the offending line below. Building needs
/// a current context.
class ShaderLibrary {
  public:
    explicit ShaderLibrary(std::optional<std::filesystem::path> directory = {});

    /// Sources without GL: for tests of what is compiled in.
    [[nodiscard]] Result<ResolvedShader> resolve(const std::string& name, const ShaderDefines& defines) const;

    /// Builds a program from stages by file ending (.vert .frag .comp). Fails with the mapped log.
    [[nodiscard]] Result<GlProgram> build(const std::vector<std::string>& names, const ShaderDefines& defines) const;

    /// As build(), but throws Error(graphics): for programs without which nothing can be drawn.
    [[nodiscard]] GlProgram require(const std::vector<std::string>& names, const ShaderDefines& defines) const;

  private:
    [[nodiscard]] Result<std::string> source(const std::string& name) const;
    std::optional<std::filesystem::path> directory_;
};

/// Rewrites driver messages such as "0:12(5): error: ..." (Mesa), "0(12) : error ..." (NVIDIA), "ERROR: 0:12: ..." to
/// "shaders/<file>:<line>: ...", with that line below, and leaves other lines as they are.
///
/// By line number alone: resolved text carries no #line, because Mesa's compiler forgets the source number that #line
/// sets (22.3.6 reports most errors as of source 0).
[[nodiscard]] std::string mapShaderLog(std::string_view log, const ResolvedShader& shader);

}  // namespace terray
