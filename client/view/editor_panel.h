#pragma once

#include <optional>
#include <string>

#include "client/view/flight_editor.h"
#include "common/projection.h"

namespace terray {

/// What the editor's window shows beside the flight, and keeps from frame to frame.
struct EditorPanel {
    std::string file;                        ///< where the flight is saved to and loaded from
    double thinMetres = 10;                  ///< of the button that thins
    bool moveLater = true;                   ///< whether later keys come along when one gets another time
    const Projection* projection = nullptr;  ///< for places; null: none is known
};

/// What a person asked of it that the flight alone does not settle.
struct EditorWishes {
    bool look = false;  ///< the camera goes to the editor's moment
    bool save = false;
    bool load = false;
    std::string failure;  ///< why something could not be done, a sentence
};

/// The window of the keyframe editor, between Gui::begin() and end(). @param camera  whose place keys are set to
/// @param open  false once it was closed
[[nodiscard]] EditorWishes drawEditor(FlightEditor& editor, EditorPanel& panel, const Camera& camera, bool& open);

}  // namespace terray
