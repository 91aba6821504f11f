#pragma once

#include <array>

#include "client/navigation/bookmarks.h"
#include "client/navigation/ground_tiles.h"
#include "client/navigation/tape.h"
#include "client/render/screen.h"
#include "client/stream/flight_recorder.h"
#include "client/view/editor_panel.h"
#include "client/view/flight_editor.h"
#include "client/view/frame_history.h"
#include "client/view/gui.h"
#include "client/view/instruments.h"
#include "client/view/quality.h"
#include "client/view/snapshot.h"
#include "client/view/view_settings.h"
#include "client/view/viewer.h"

namespace terray {

/// All that a viewer is made of: the loop is in viewer.cpp, what a person asks for in viewer_commands.cpp, what is
/// drawn over the picture in viewer_gui.cpp, editing flights in viewer_editing.cpp.
struct Viewer::State {
    State(const TileSource& tiles, const ShaderLibrary& shaders, const ViewerOptions& given);
    ~State();

    // The loop.
    /// @param seconds  since the last turn  @param flown  of these, those that the camera flew
    bool advance(const std::vector<WindowEvent>& events, double seconds, double flown);
    void take(const WindowEvent& event);
    /// While a picture is taken: Esc gives it up.
    void takeDuringPicture(const WindowEvent& event);
    void moveCamera(double flown);
    /// Whether something is on its way without anybody touching anything.
    [[nodiscard]] bool moving() const;
    void draw(double seconds);
    void noteProgress();
    /// Declares what is drawn over the picture, and fills the window's back buffer.
    void compose();
    void present();
    [[nodiscard]] NavigationScene scene();
    /// The ground under a pixel of the window: a place of the dataset, heights not exaggerated.
    [[nodiscard]] std::optional<glm::dvec3> placeUnder(glm::dvec2 pixel) const;
    [[nodiscard]] std::optional<glm::dvec3> pick(glm::dvec2 pixel) const;

    // What a person asks for.
    void obey(const CommandEvent& event);
    void say(std::string text);
    [[nodiscard]] Camera home() const;
    void recallOrStore(const CommandEvent& event);
    void goToPlace(const std::string& text);
    void copyCamera();
    void takePicture();
    /// Draws the next part of the picture that is being taken.
    void continuePicture();
    void endPicture();
    void startOrSaveRecording();
    void startOrStopReplay();
    void cancel();
    /// What is done to the flight that is edited; nothing when none is.
    void edit(Command command);
    void openOrCloseEditor();
    void saveEdited();
    void keepEditedFile(const std::filesystem::path& path);
    void loadToEdit();
    /// Puts the camera to where the edited flight is at its moment.
    void lookAtMoment();
    /// The revision of the edited flight whose marks belong in the picture; none without editor and on the path itself.
    [[nodiscard]] std::optional<uint64_t> wantedMarks() const;
    void drawMarks();
    /// After settings have changed.
    void applySettings();
    /// Settings with the tolerances and photo of the quality that the frame rate allows.
    void applyQuality();
    [[nodiscard]] std::filesystem::path pictureName(const std::string& stem, const std::string& extension) const;
    [[nodiscard]] const Projection* projectionOrNull() const { return projection ? &*projection : nullptr; }

    // What is drawn over the picture.
    void declareGui();
    void declareMap();
    void declareTape();
    void declareEditor();
    [[nodiscard]] std::string readout();
    [[nodiscard]] std::string cameraLine() const;
    /// The view of the window, whatever the picture's own size.
    [[nodiscard]] View windowView() const;

    const TileSource& source;
    ViewerOptions options;
    std::optional<Projection> projection;
    Window window;
    Gui gui;
    Engine engine;
    GroundTiles ground;
    Navigator navigator;
    Controls controls;
    Screen screen;
    ViewSettings settings;
    Quality quality;
    FrameReport report;
    FrameHistory history;
    std::optional<StepCount> steps;

    Camera drawn;        ///< by the last frame
    bool stale = true;   ///< the picture is not what it should be
    int uncomposed = 3;  ///< frames until panels have come to rest
    bool paging = true;  ///< tiles are on their way
    int barrenFrames = 0;
    std::chrono::steady_clock::time_point progress =
        std::chrono::steady_clock::now();  ///< tiles came, or were asked for
    double clock = 0;                      ///< seconds of all turns
    std::optional<double> retryAt;
    std::chrono::steady_clock::time_point lastTurn = std::chrono::steady_clock::now();
    std::optional<double> firstPictureMs;
    std::optional<double> fullDetailMs;

    bool help = false;
    bool goTo = false;
    bool frozen = false;
    bool measuring = false;
    std::string goToFailure;
    std::string notice;
    double noticeUntil = 0;
    std::optional<std::filesystem::path> bookmarksFile;
    Bookmarks bookmarks;
    std::vector<glm::dvec2> tape;  ///< its ends, at most two
    std::unique_ptr<GroundTiles> tapeGround;
    std::optional<FlightRecorder> recorder;
    Flight lastFlight;
    std::optional<double> replayed;   ///< seconds of lastFlight that have been shown
    std::optional<Snapshot> picture;  ///< being taken; nothing else is drawn meanwhile
    std::optional<FlightEditor> editor;
    EditorPanel editorPanel;
    std::optional<std::filesystem::path> editedFile;  ///< what the editor loaded or saved, and may replace
    uint64_t editedOrigin = 0;                        ///< FlightEditor::origin() of the flight in that file
    bool lastFlightChanged = false;                   ///< in the editor, and not saved since
    std::optional<uint64_t> marked;                   ///< revision of the flight whose marks are in the picture
};

}  // namespace terray
