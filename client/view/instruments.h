#pragma once

#include <optional>
#include <span>

#include "client/engine/engine.h"
#include "client/view/frame_history.h"

namespace terray {

/// Steps of the last frame's rays, where they are counted.
struct StepCount {
    double mean = 0;
    uint32_t most = 0;
};

/// What the instruments show.
struct InstrumentReadings {
    const FrameReport& report;
    const FrameHistory& history;
    const EngineOptions& options;
    double seconds = 0;  ///< on the history's clock
    std::optional<StepCount> steps;
    glm::ivec2 picture{0};  ///< pixels of the engine's picture
    std::string camera;     ///< mode, height over ground, speed
};
/// Frame times, tiles, memory against budgets, what is missing.
void drawInstruments(const InstrumentReadings& readings);

/// Lines beside the cursor.
void drawReadout(glm::dvec2 cursor, const std::string& text);

/// An arrow to true north in the upper right corner, as the map lies under the camera. @param north  clockwise from the
/// picture's top
void drawNorthArrow(Radians north);

/// A bar in the lower left corner: so long is a length of ground where the picture's middle is.
void drawScaleBar(Pixels pixels, Metres length);

/// The boxes of nodes as they are seen, in colours of their level.
void drawTileBoxes(const View& view, const Tiling& tiling, std::span<const DrawNode> nodes);

/// A line of text at the top, such as what was just done.
void drawNotice(const std::string& text);

}  // namespace terray
