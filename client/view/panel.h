#pragma once

#include "client/view/view_settings.h"
#include "common/units.h"

namespace terray {

/// The panel of settings, between Gui::begin() and end(). @return whether something was changed
/// @param fieldOfView  vertical, of the camera
bool drawPanel(ViewSettings& settings, Radians& fieldOfView);

/// The table of keys, with a button that closes it (F1 too).
void drawHelp(bool& open);

/// The line "lat, lon" or "x, y" that a person is asked for. @return the text once Enter was pressed
/// @param open  true while it is shown  @param failure  of the last answer, shown beneath
[[nodiscard]] std::optional<std::string> drawGoTo(bool& open, const std::string& failure);

}  // namespace terray
