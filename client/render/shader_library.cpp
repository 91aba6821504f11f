#include "client/render/shader_library.h"

#include <algorithm>
#include <fstream>
#include <functional>
#include <iterator>
#include <regex>
#include <set>

#include "client/render/embedded_shaders.h"
#include "common/error.h"

namespace terray {
namespace {

/// Files within files within files: more than this is a mistake.
constexpr size_t kMaxIncludeDepth = 16;

/// Calls visit(line number from 1, line without its end) for each line of a text.
template <class Visit>
void forEachLine(std::string_view text, Visit visit) {
    for (int number = 1; !text.empty(); ++number) {
        const size_t end = std::min(text.find('\n'), text.size());
        visit(number, text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
}

std::string_view trimmed(std::string_view text) {
    const size_t first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r") + 1 - first);
}

/// What an include line asks for.
struct Include {
    bool foreign = false;  ///< a C++ header in angle brackets, of a file that is shared with C++
    std::string name;      ///< relative to shaders/
};

std::optional<Include> parseInclude(std::string_view line) {
    static const std::regex kInclude(R"(\s*#\s*include\s*([<"])([^>"]+)[>"].*)");
    std::match_results<std::string_view::const_iterator> match;
    if (line.find("include") == std::string_view::npos) return {};
    if (!std::regex_match(line.begin(), line.end(), match, kInclude)) return {};
    std::string name = match[2];
    // C++ names shared files from the repository's root.
    if (name.starts_with("shaders/")) name.erase(0, std::string_view("shaders/").size());
    return Include{.foreign = match[1] == "<", .name = std::move(name)};
}

/// One shader's includes being resolved, depth first.
class Resolver {
  public:
    using Source = std::function<Result<std::string>(const std::string&)>;
    explicit Resolver(Source source) : source_(std::move(source)) {}

    /// Appends a line of text.
    void addLine(std::string_view content, ResolvedShader::Origin origin) {
        shader.text.append(content);
        shader.text += '\n';
        shader.origins.push_back(origin);
    }
    /// Appends a file and everything it includes.
    Result<void> addFile(const std::string& name) {
        const Result<std::string> text = source_(name);
        if (!text.ok()) return text.failure();
        const size_t number = numberOf(name);
        if (features_ == 0) settled_.insert(name);
        open_.push_back(name);
        Result<void> result;
        forEachLine(text.value(), [&](int line, std::string_view content) {
            if (!result.ok()) return;
            if (const std::optional<Include> include = parseInclude(content)) {
                result = addInclude(*include, "shaders/" + name + ":" + std::to_string(line));
            } else {
                followConditionals(content);
                addLine(content, {number, line});
            }
        });
        open_.pop_back();
        return result;
    }

    ResolvedShader shader;

  private:
    size_t numberOf(const std::string& name) {
        const auto found = std::ranges::find(shader.files, name);
        if (found == shader.files.end()) shader.files.push_back(name);
        return static_cast<size_t>(std::ranges::find(shader.files, name) - shader.files.begin());
    }

    /// Keeps count of the features' conditionals, #if; #ifndef and #ifdef guard files and are none.
    void followConditionals(std::string_view line) {
        const std::string_view directive = trimmed(line);
        if (directive.starts_with("#if")) {
            const bool feature = directive.starts_with("#if ");
            conditionals_.push_back(feature);
            features_ += feature ? 1 : 0;
        } else if (directive.starts_with("#endif") && !conditionals_.empty()) {
            features_ -= conditionals_.back() ? 1 : 0;
            conditionals_.pop_back();
        }
    }

    Result<void> addInclude(const Include& include, const std::string& where) {
        if (include.foreign) return {};
        const auto refuse = [&](const std::string& why) {
            return Failure{where + ": cannot include \"" + include.name + "\": " + why};
        };
        if (std::ranges::count(open_, include.name) > 0) return refuse("it includes this file (a cycle)");
        if (settled_.contains(include.name)) return {};
        if (open_.size() > kMaxIncludeDepth) {
            return refuse("more than " + std::to_string(kMaxIncludeDepth) + " files within each other");
        }
        const size_t before = shader.files.size();
        Result<void> result = addFile(include.name);
        // Its own source is missing: say who asked. Deeper faults name their own line.
        if (!result.ok() && shader.files.size() == before) return refuse(result.failure().message);
        return result;
    }

    Source source_;
    std::set<std::string> settled_;   ///< files whose text is there whatever features are on
    std::vector<bool> conditionals_;  ///< the open ones, outermost first: whether it asks for a feature
    int features_ = 0;                ///< how many of them do
    std::vector<std::string> open_;   ///< the files whose includes are being resolved, outermost first
};

/// A line of a driver's log that speaks of a line of a shader.
struct LogLine {
    size_t line = 0;  ///< from 1
    std::string message;
};

std::optional<LogLine> parseLogLine(std::string_view text) {
    // Nine digits fit any number type; no shader has more lines.
    static const std::regex kMesa(R"(\d+:(\d{1,9})\(\d+\)\s*:\s*(.*))");
    static const std::regex kNvidia(R"(\d+\((\d{1,9})\)\s*:\s*(.*))");
    static const std::regex kOthers(R"((ERROR|WARNING):\s*\d+:(\d{1,9}):\s*(.*))");
    std::match_results<std::string_view::const_iterator> match;
    const auto matches = [&](const std::regex& form) {
        return std::regex_match(text.begin(), text.end(), match, form);
    };
    if (matches(kMesa) || matches(kNvidia)) return LogLine{std::stoul(match[1]), match[2]};
    if (!matches(kOthers)) return {};
    return LogLine{std::stoul(match[2]), (match[1] == "ERROR" ? "error: " : "warning: ") + match[3].str()};
}

/// Line `number` of a text, from 1; empty when there is none.
std::string_view lineOf(std::string_view text, size_t number) {
    std::string_view found;
    forEachLine(text, [&](int at, std::string_view line) {
        if (static_cast<size_t>(at) == number) found = trimmed(line);
    });
    return found;
}

GLenum stageOf(const std::string& name) {
    if (name.ends_with(".vert")) return GL_VERTEX_SHADER;
    if (name.ends_with(".frag")) return GL_FRAGMENT_SHADER;
    if (name.ends_with(".comp")) return GL_COMPUTE_SHADER;
    return GL_NONE;
}

std::string shaderLog(GLuint shader) {
    GLint length = 0;
    glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<size_t>(std::max(length, 0)), '\0');
    GLsizei written = 0;
    if (length > 0) glGetShaderInfoLog(shader, length, &written, log.data());
    log.resize(static_cast<size_t>(written));
    return log;
}

std::string programLog(GLuint program) {
    GLint length = 0;
    glGetProgramiv(program, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<size_t>(std::max(length, 0)), '\0');
    GLsizei written = 0;
    if (length > 0) glGetProgramInfoLog(program, length, &written, log.data());
    log.resize(static_cast<size_t>(written));
    return log;
}

std::string joined(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : " + ") + name;
    return text;
}

}  // namespace

ShaderLibrary::ShaderLibrary(std::optional<std::filesystem::path> directory) : directory_(std::move(directory)) {}

Result<std::string> ShaderLibrary::source(const std::string& name) const {
    // One name for each file, so that "once" means once.
    if (name.starts_with('/') || name.find("..") != std::string::npos || name.find("./") != std::string::npos) {
        return Failure{"\"" + name + "\" is not a plain name relative to shaders/"};
    }
    if (directory_) {
        std::ifstream file(*directory_ / name, std::ios::binary);
        if (file) return std::string(std::istreambuf_iterator<char>(file), {});
    }
    for (const EmbeddedShader& shader : embeddedShaders()) {
        if (shader.name == name) return std::string(shader.text);
    }
    std::string places = "this program";
    if (directory_) places = directory_->string() + " and " + places;
    return Failure{"there is no shaders/" + name + " in " + places};
}

Result<ResolvedShader> ShaderLibrary::resolve(const std::string& name, const ShaderDefines& defines) const {
    Resolver resolver([this](const std::string& file) { return source(file); });
    resolver.addLine("#version 450 core", {});
    for (const auto& [key, value] : defines) resolver.addLine("#define " + key + " " + value, {});
    const Result<void> result = resolver.addFile(name);
    if (!result.ok()) return result.failure();
    return std::move(resolver.shader);
}

Result<GlProgram> ShaderLibrary::build(const std::vector<std::string>& names, const ShaderDefines& defines) const {
    const auto failed = [&](const std::string& why) {
        return Failure{"cannot build the GPU program " + joined(names) + ":\n" + why};
    };
    GlProgram program(glCreateProgram());
    for (const std::string& name : names) {
        const GLenum stage = stageOf(name);
        if (stage == GL_NONE) return failed("shaders/" + name + " is none of .vert, .frag, .comp");
        const Result<ResolvedShader> resolved = resolve(name, defines);
        if (!resolved.ok()) return failed(resolved.failure().message);
        const GlShader shader(glCreateShader(stage));
        const char* const text = resolved->text.c_str();
        glShaderSource(shader.name(), 1, &text, nullptr);
        glCompileShader(shader.name());
        GLint compiled = GL_FALSE;
        glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &compiled);
        if (compiled != GL_TRUE) {
            return failed(mapShaderLog(shaderLog(shader.name()), resolved.value()));
        }
        glAttachShader(program.name(), shader.name());  // keeps it alive as long as the program
    }
    glLinkProgram(program.name());
    GLint linked = GL_FALSE;
    glGetProgramiv(program.name(), GL_LINK_STATUS, &linked);
    // A linker's line numbers do not say of which stage they are, so its words are passed on as they are.
    if (linked != GL_TRUE) return failed(programLog(program.name()));
    return program;
}

GlProgram ShaderLibrary::require(const std::vector<std::string>& names, const ShaderDefines& defines) const {
    Result<GlProgram> program = build(names, defines);
    if (!program.ok()) throw Error(ExitCode::graphics, program.failure().message);
    return std::move(program).value();
}

std::string mapShaderLog(std::string_view log, const ResolvedShader& shader) {
    std::string mapped;
    // Some drivers count the terminating zero as part of the log.
    forEachLine(log.substr(0, log.find('\0')), [&](int, std::string_view text) {
        const std::optional<LogLine> found = parseLogLine(trimmed(text));
        if (!found || found->line == 0 || found->line > shader.origins.size()) {
            mapped.append(text);
            mapped += '\n';
            return;
        }
        const auto& [file, line] = shader.origins[found->line - 1];
        mapped += "shaders/" + shader.files[file] + ":" + std::to_string(line) + ": " + found->message + "\n    ";
        mapped.append(lineOf(shader.text, found->line));
        mapped += '\n';
    });
    return mapped;
}

}  // namespace terray
