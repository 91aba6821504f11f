#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/geodesy.h"
#include "common/result.h"

namespace terray {

/// What a KML altitude counts from.
enum class KmlAltitude { ground, aboveGround, absolute };

/// A <Camera>, or a <LookAt> when it has a range. Degrees; roll is left out.
struct KmlView {
    LonLat place;         ///< of the eye; with a range of what is looked at
    double altitude = 0;  ///< metres, 0 for KmlAltitude::ground
    KmlAltitude mode = KmlAltitude::ground;
    double heading = 0;                   ///< from true north
    double tilt = 0;                      ///< of the view axis: 0 straight down, 90 to the horizon
    std::optional<double> range;          ///< metres from the eye to the place looked at
    std::optional<double> horizontalFov;  ///< gx:horizFov
};

/// One element of a playlist.
struct KmlStep {
    double seconds = 0;           ///< of the way there, or of the wait
    std::optional<KmlView> view;  ///< none: gx:Wait
    bool smooth = false;          ///< gx:flyToMode: passes by; else (bounce) it comes to rest
};

/// A gx:Tour.
struct KmlTour {
    std::string name;
    std::vector<KmlStep> steps;
};

/// The first gx:Tour of a KML document: its gx:FlyTo and gx:Wait; sounds, updates and pauses for a click are left out.
/// Trusts nothing; fails, with a sentence, on bytes that are no whole XML document, on one that is no KML or has no
/// tour, on a number that is missing or out of range. In a build without TERRAY_WITH_TRACKS it always fails.
///
/// Source: Open Geospatial Consortium 2015, "KML 2.3" (OGC 12-007r2); Google, "KML Reference", the gx extensions.
[[nodiscard]] Result<KmlTour> parseKml(std::string_view bytes);

/// A KML 2.2 document with this tour: UTF-8, numbers in full precision.
[[nodiscard]] std::string toKml(const KmlTour& tour);

}  // namespace terray
