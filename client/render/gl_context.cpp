#include "client/render/gl_context.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>
#include <utility>
#include <vector>

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include "common/check.h"
#include "common/error.h"

namespace terray {
namespace {

/// Layers that OpenGL 4.5 promises; a driver with fewer reports a version it does not implement.
constexpr GLint kNeededArrayLayers = 2048;

std::string eglErrorName(EGLint code) {
    static constexpr std::array<std::string_view, 15> kNames = {
        "EGL_SUCCESS",       "EGL_NOT_INITIALIZED", "EGL_BAD_ACCESS",        "EGL_BAD_ALLOC",
        "EGL_BAD_ATTRIBUTE", "EGL_BAD_CONFIG",      "EGL_BAD_CONTEXT",       "EGL_BAD_CURRENT_SURFACE",
        "EGL_BAD_DISPLAY",   "EGL_BAD_MATCH",       "EGL_BAD_NATIVE_PIXMAP", "EGL_BAD_NATIVE_WINDOW",
        "EGL_BAD_PARAMETER", "EGL_BAD_SURFACE",     "EGL_CONTEXT_LOST",
    };
    const auto index = static_cast<size_t>(code - EGL_SUCCESS);
    if (index < kNames.size()) return std::string(kNames[index]);
    std::array<char, 24> text{};
    std::snprintf(text.data(), text.size(), "EGL error 0x%04x", static_cast<unsigned>(code));
    return text.data();
}

/// Whether a list of names, separated by spaces, holds one of them whole.
bool listHas(const char* list, std::string_view name) {
    for (std::string_view rest = list == nullptr ? "" : list; !rest.empty();) {
        const size_t end = std::min(rest.find(' '), rest.size());
        if (rest.substr(0, end) == name) return true;
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return false;
}

/// A place where a context may be had.
struct Candidate {
    EGLenum platform = 0;
    void* native = nullptr;  ///< EGLDeviceEXT, or the default display
    bool software = false;
    const char* name = "";  ///< for GlStrings::platform
    std::string detail;     ///< which one of several, for messages
};

std::vector<Candidate> deviceCandidates() {
    std::array<EGLDeviceEXT, 32> devices{};
    EGLint count = 0;
    if (!eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count)) return {};
    std::vector<Candidate> found;
    for (EGLint i = 0; i < count; ++i) {
        const char* const extensions = eglQueryDeviceStringEXT(devices[i], EGL_EXTENSIONS);
        const bool software = listHas(extensions, "EGL_MESA_device_software");
        std::string detail = " " + std::to_string(i);
        if (software) detail += " (software)";
        if (listHas(extensions, "EGL_EXT_device_drm")) {
            const char* const file = eglQueryDeviceStringEXT(devices[i], EGL_DRM_DEVICE_FILE_EXT);
            if (file != nullptr) detail += std::string(" (") + file + ")";
        }
        found.push_back({EGL_PLATFORM_DEVICE_EXT, devices[i], software, "EGL device", std::move(detail)});
    }
    // Hardware first; otherwise the driver's own order.
    std::stable_partition(found.begin(), found.end(), [](const Candidate& device) { return !device.software; });
    return found;
}

/// Everything worth trying, best first. Notes what cannot even be tried.
std::vector<Candidate> candidates(std::string& report) {
    const char* const extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    std::vector<Candidate> found;
    if (!listHas(extensions, "EGL_EXT_platform_base")) {
        report += "\n  EGL has no driver, or none with platform displays (EGL_EXT_platform_base)";
        return found;
    }
    // Older drivers name the two parts of EGL_EXT_device_base by one extension.
    const bool canEnumerate =
        listHas(extensions, "EGL_EXT_device_enumeration") || listHas(extensions, "EGL_EXT_device_base");
    if (canEnumerate && listHas(extensions, "EGL_EXT_platform_device")) {
        found = deviceCandidates();
        if (found.empty()) report += "\n  EGL device: there are no devices";
    } else {
        report += "\n  EGL device: not supported by this EGL";
    }
    if (listHas(extensions, "EGL_MESA_platform_surfaceless")) {
        found.push_back({EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, true, "EGL surfaceless", ""});
    } else {
        report += "\n  EGL surfaceless: not supported by this EGL";
    }
    return found;
}

struct Made {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;
    std::string failure;  ///< why there is no context
};

/// Makes a context at one place and makes it current. Displays belong to the whole process and are shared by all
/// contexts of a place, so they are left initialised until the process ends.
Made makeContext(const Candidate& candidate, bool debug) {
    const auto failed = [](const std::string& what) {
        return Made{.failure = what + ": " + eglErrorName(eglGetError())};
    };
    EGLDisplay display = eglGetPlatformDisplayEXT(candidate.platform, candidate.native, nullptr);
    if (display == EGL_NO_DISPLAY) return failed("eglGetPlatformDisplay");
    EGLint major = 0;
    EGLint minor = 0;
    if (!eglInitialize(display, &major, &minor)) return failed("eglInitialize");
    if (std::pair(major, minor) < std::pair(1, 5)) {
        return {.failure = "EGL " + std::to_string(major) + "." + std::to_string(minor) + ", 1.5 is needed"};
    }
    const char* const extensions = eglQueryString(display, EGL_EXTENSIONS);
    for (const char* const needed : {"EGL_KHR_no_config_context", "EGL_KHR_surfaceless_context"}) {
        // The first one has an older name.
        const bool older = needed == std::string_view("EGL_KHR_no_config_context") &&
                           listHas(extensions, "EGL_MESA_configless_context");
        if (!listHas(extensions, needed) && !older) return {.failure = std::string(needed) + " is not supported"};
    }
    if (!eglBindAPI(EGL_OPENGL_API)) return failed("eglBindAPI(EGL_OPENGL_API)");
    const std::array<EGLint, 9> attributes = {EGL_CONTEXT_MAJOR_VERSION,
                                              4,
                                              EGL_CONTEXT_MINOR_VERSION,
                                              5,
                                              EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                              EGL_CONTEXT_OPENGL_DEBUG,
                                              debug ? EGL_TRUE : EGL_FALSE,
                                              EGL_NONE};
    EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
    if (context == EGL_NO_CONTEXT) return failed("eglCreateContext (OpenGL 4.5 core)");
    if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
        Made result = failed("eglMakeCurrent");
        eglDestroyContext(display, context);
        return result;
    }
    return {.display = display, .context = context, .failure = {}};
}

std::string glString(GLenum which) {
    const auto* const text = glGetString(which);
    return text == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(text));
}

/// Collects errors and undefined behaviour. Shader compilers' messages are left out: ShaderLibrary reports them.
void GLAPIENTRY collectMessage(GLenum source, GLenum type, GLuint, GLenum, GLsizei length, const GLchar* message,
                               const void* messages) {
    if (source == GL_DEBUG_SOURCE_SHADER_COMPILER) return;
    if (type != GL_DEBUG_TYPE_ERROR && type != GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR) return;
    auto& collected = *static_cast<std::string*>(const_cast<void*>(messages));
    collected += length < 0 ? std::string_view(message) : std::string_view(message, static_cast<size_t>(length));
    if (!collected.ends_with('\n')) collected += '\n';
}

}  // namespace

struct HeadlessContext::State {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;
    GlStrings strings;
    std::string messages;  ///< written by the driver on this thread (synchronous debug output)
};

HeadlessContext::HeadlessContext() : HeadlessContext(Options()) {}

HeadlessContext::HeadlessContext(const Options& options) : state_(std::make_unique<State>()) {
    constexpr const char* kAttempt = "cannot make an OpenGL 4.5 context without a window";
    constexpr const char* kRemedy = "install a driver with EGL and OpenGL 4.5 (Debian: libegl1 and libgl1-mesa-dri)";
    if (!epoxy_has_egl()) {
        throw Error(ExitCode::graphics, std::string(kAttempt) + ": libEGL.so.1 was not found; " + kRemedy);
    }
    TERRAY_CHECK(eglGetCurrentContext() == EGL_NO_CONTEXT);  // one per thread
    std::string report;
    for (const Candidate& candidate : candidates(report)) {
        const Made made = makeContext(candidate, options.debug);
        if (made.context == EGL_NO_CONTEXT) {
            report += std::string("\n  ") + candidate.name + candidate.detail + ": " + made.failure;
            continue;
        }
        state_->display = made.display;
        state_->context = made.context;
        state_->strings = currentGlStrings(candidate.name);
        if (options.debug) collectDebugMessages(state_->messages);
        return;
    }
    throw Error(ExitCode::graphics, std::string(kAttempt) + ":" + report + "\n" + kRemedy);
}

HeadlessContext::~HeadlessContext() {
    eglMakeCurrent(state_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(state_->display, state_->context);
    eglReleaseThread();
}

const GlStrings& HeadlessContext::strings() const {
    return state_->strings;
}

std::string HeadlessContext::takeDebugMessages() {
    return std::exchange(state_->messages, {});
}

void collectDebugMessages(std::string& messages) {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(collectMessage, &messages);
}

GlStrings currentGlStrings(std::string platform) {
    return {.vendor = glString(GL_VENDOR),
            .renderer = glString(GL_RENDERER),
            .version = glString(GL_VERSION),
            .platform = std::move(platform)};
}

void requireRendererFeatures() {
    std::string missing;
    const auto require = [&](bool present, const std::string& what) {
        if (!present) missing += "\n  " + what;
    };
    const auto hasAny = [](std::initializer_list<const char*> names) {
        return std::any_of(names.begin(), names.end(), [](const char* name) { return epoxy_has_gl_extension(name); });
    };
    const int version = epoxy_gl_version();
    require(epoxy_is_desktop_gl() && version >= 45, "OpenGL 4.5 core");
    require(hasAny({"GL_EXT_texture_compression_s3tc"}), "S3TC textures (GL_EXT_texture_compression_s3tc)");
    require(hasAny({"GL_EXT_texture_sRGB"}), "S3TC textures in sRGB (GL_EXT_texture_sRGB)");
    require(version >= 46 || hasAny({"GL_ARB_texture_filter_anisotropic", "GL_EXT_texture_filter_anisotropic"}),
            "anisotropic filtering (GL_EXT_texture_filter_anisotropic)");
    GLint layers = 0;
    glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &layers);
    require(layers >= kNeededArrayLayers, std::to_string(kNeededArrayLayers) +
                                              " array texture layers (GL_MAX_ARRAY_TEXTURE_LAYERS is " +
                                              std::to_string(layers) + ")");
    if (missing.empty()) return;
    const GlStrings strings = currentGlStrings("");
    throw Error(ExitCode::graphics, "cannot draw with \"" + strings.renderer + "\" (" + strings.version +
                                        "); it lacks:" + missing + "\nupdate its driver, or use another device");
}

}  // namespace terray
