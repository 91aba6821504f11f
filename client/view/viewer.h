#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "client/engine/engine.h"
#include "client/navigation/navigator.h"
#include "client/view/arguments.h"
#include "client/view/controls.h"
#include "client/view/view_settings.h"
#include "client/view/window.h"
#include "common/grid.h"
#include "common/rgba.h"

namespace terray {

/// How a viewer begins.
struct ViewerOptions {
    std::string datasetName;
    Arguments arguments;                             ///< of the program, as they stand in the JSON beside pictures
    Json remembered;                                 ///< panels of the last run
    std::filesystem::path pictures = ".";            ///< where pictures and flights go
    std::optional<std::filesystem::path> bookmarks;  ///< none: they live as long as the viewer
    std::optional<glm::ivec2> part;                  ///< of pictures, as in PictureInParts
    double targetFps = 0;                            ///< see Quality
    Window::Options window;
    EngineOptions engine;
    std::optional<Camera> camera;                                                      ///< none: all of the dataset
    std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();  ///< of the program
};

class FlightEditor;

/// The flight viewer: a window, a camera that a person flies, and the engine that draws what it sees, on demand: a
/// frame is drawn when something moved, has come or was uncovered, and at no other time. Main thread only.
///
/// From an input to its picture there is one frame: events are taken right before the frame is drawn, the frame waits
/// for the GPU, and the next swap shows it. No frame is queued ahead.
class Viewer {
  public:
    /// Throws as Window, Engine and GroundTiles do. @param source, shaders  outlive the viewer
    Viewer(const TileSource& source, const ShaderLibrary& shaders, const ViewerOptions& options);
    ~Viewer();

    /// Until the window is closed. Throws Error(interrupted) at a signal.
    void run();
    /// One turn of the loop: takes events, or waits for one at most so long when there is nothing to do; moves the
    /// camera for the time since the last turn; draws if there is something to show. @return whether it drew
    bool turn(double waitSeconds);
    /// The same with a given time between turns: for tests.
    bool turnFor(double seconds);

    [[nodiscard]] Window& window();
    [[nodiscard]] const Navigator& navigator() const;
    [[nodiscard]] const Engine& engine() const;
    /// Of the last frame.
    [[nodiscard]] const FrameReport& report() const;
    [[nodiscard]] const ViewSettings& settings() const;
    /// The line that is told right now, such as where a picture went.
    [[nodiscard]] const std::string& notice() const;
    /// Whether it shows what was selected for an earlier camera (F).
    [[nodiscard]] bool frozen() const;
    /// The flight that is edited (K); null when none is.
    [[nodiscard]] const FlightEditor* editor() const;
    /// What the window shows: the last frame with all that is drawn over it.
    [[nodiscard]] Grid<Rgba> screenshot();
    /// Milliseconds from the program's start to its first picture, and to the first whose tiles were all there.
    [[nodiscard]] std::optional<double> firstPictureMs() const;
    [[nodiscard]] std::optional<double> fullDetailMs() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace terray
