#pragma once

#include <array>
#include <filesystem>
#include <optional>

#include <glm/vec2.hpp>

#include "client/engine/engine.h"
#include "client/view/arguments.h"
#include "common/json.h"

namespace terray {

/// Where the sun of a viewer stands: at an hour of a day, or where it was put.
struct SunSetting {
    bool byTime = false;
    double azimuthDegrees = 315;  ///< clockwise from grid north
    double elevationDegrees = 40;
    int year = 2026, month = 6, day = 21;
    int minute = 12 * 60;  ///< of the day, UTC

    [[nodiscard]] UtcTime time() const;
    void setTime(UtcTime time);
    /// "315,40", as --sun takes it.
    [[nodiscard]] std::string text() const;
};

/// How large the pictures are that a person takes in the window: as wide as it, times so much, or at most 16384 pixels
/// on the longer side.
enum class PictureSize : uint8_t { window, twice, fourTimes, wide };
inline constexpr std::array<const char*, 4> kPictureSizes = {"as the window", "2 times as wide", "4 times as wide",
                                                             "16384 wide"};
/// In pixels, of the window's shape. @param window  its size, each side > 0
[[nodiscard]] glm::ivec2 pictureSize(PictureSize size, glm::ivec2 window);

/// What a person changes in the panel while flying.
struct ViewSettings {
    EngineOptions engine;  ///< selection, render, earth, exaggeration: what Engine::setOptions takes
    SunSetting sun;
    bool canTellTime = false;  ///< the dataset's place on the earth is known
    bool hasPhoto = false;
    bool panel = true;
    bool instruments = true;
    bool countSteps = false;
    bool vsync = true;
    double targetFps = 0;  ///< 0: full quality at any rate
    PictureSize pictureSize = PictureSize::window;

    /// Brings engine's sun and statistics in line with the rest.
    void settle();
};

/// The settings that a viewer begins with.
[[nodiscard]] ViewSettings settingsFrom(const EngineOptions& options, const DatasetMetadata& metadata);

/// What the panel can change, as options of terray-view.
[[nodiscard]] OptionTexts engineTexts(const ViewSettings& settings);
/// A command line with these in place of what it said of them. @param arguments  as given to the program
[[nodiscard]] Arguments withEngineTexts(const Arguments& arguments, const ViewSettings& settings);

/// What is remembered from one run to the next: options that were not given on the command line, panels.
[[nodiscard]] Json toJson(const ViewSettings& settings);
/// A command line with the remembered options that it does not give; what is not understood is left out.
/// @param canTellTime  an hour of the day makes sense
[[nodiscard]] Arguments withRemembered(const Json& remembered, const Arguments& arguments, bool canTellTime);
/// Panels as they were.
void restorePanels(const Json& remembered, ViewSettings& settings);

/// $XDG_CONFIG_HOME/terray, or ~/.config/terray; none where the environment names neither.
[[nodiscard]] std::optional<std::filesystem::path> configFolder();

}  // namespace terray
