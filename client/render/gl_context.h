#pragma once

#include <memory>
#include <string>

namespace terray {

/// What the driver says of itself, for manifests and messages.
struct GlStrings {
    std::string vendor;
    std::string renderer;
    std::string version;
    std::string platform;  ///< how the context was made: "EGL device", "EGL surfaceless", "window"
};

/// An OpenGL 4.5 core context without a window, by raw EGL: the device platform first (a GPU without a display server),
/// then Mesa's surfaceless platform (software). No surface: everything is drawn into framebuffer objects.
///
/// Current on the thread that made it, from construction to destruction; one per thread.
/// Throws Error(graphics) when none can be made, listing what was tried and what each attempt answered.
class HeadlessContext {
  public:
    struct Options {
        bool debug = false;  ///< a debug context: GL errors are collected, see takeDebugMessages()
    };
    HeadlessContext();
    explicit HeadlessContext(const Options& options);
    ~HeadlessContext();
    HeadlessContext(const HeadlessContext&) = delete;
    HeadlessContext& operator=(const HeadlessContext&) = delete;

    [[nodiscard]] const GlStrings& strings() const;
    /// Errors and undefined behaviour that the driver reported since the last call, one a line; empty is well.
    [[nodiscard]] std::string takeDebugMessages();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Strings of the context that is current. @param platform  how it was made
[[nodiscard]] GlStrings currentGlStrings(std::string platform);

/// From now on errors and undefined behaviour that the driver reports in the current context, which should be a debug
/// context, are appended to `messages`, one a line. @param messages  outlives the context
void collectDebugMessages(std::string& messages);

/// Throws Error(graphics) naming every missing thing when the current context lacks what the renderer needs: GL 4.5,
/// S3TC with sRGB, anisotropic filtering, enough array layers.
void requireRendererFeatures();

}  // namespace terray
