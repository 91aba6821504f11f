#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/geodesy.h"
#include "common/result.h"

namespace terray {

/// One fix of a track.
struct TrackPoint {
    LonLat place;
    /// Metres above whatever the recorder counts from: the geoid in most GPX files, the ellipsoid in most IGC files.
    /// None where the file says none.
    std::optional<double> height;
    /// When it was taken, from some moment that all points of a track share. None where the file does not say.
    std::optional<double> seconds = {};
};

/// A recorded way: lines of at least one point each. Where the recording was interrupted a new line begins.
struct Track {
    std::vector<std::vector<TrackPoint>> lines;
};

/// Largest track file that is read. A day's flight at ten fixes a second is 30 MB of GPX.
inline constexpr uint64_t kMostTrackBytes = 256ull << 20;

/// The track in a GPX 1.0 or 1.1 file: its tracks' segments and its routes; waypoints are left out. Trusts nothing;
/// fails, with a sentence, on bytes that are no whole XML document, on a document that is no GPX, on a place that is
/// missing or is out of range, and where there is no point at all. A time that is none by ISO 8601 counts as missing.
/// In a build without TERRAY_WITH_TRACKS it always fails.
///
/// Source: Topografix 2004, "GPX 1.1 Schema Documentation".
[[nodiscard]] Result<Track> parseGpx(std::string_view bytes);

/// The track in an IGC file, the flight recorders' text of fixed columns: its B records. The height is the GNSS one, or
/// where the fix has none (validity V) the barometric one. A time of day that is earlier by more than half a day is the
/// next day's. Fails, naming the line, on a B record that is cut short or is out of range, and where there is none at
/// all. Other records are skipped unread.
///
/// Source: FAI International Gliding Commission 2020, "Technical Specification for GNSS Flight Recorders", appendix A.
[[nodiscard]] Result<Track> parseIgc(std::string_view bytes);

/// All of a file of at most kMostTrackBytes. Throws Error(input).
[[nodiscard]] std::string readTrackFile(const std::filesystem::path& path);

/// Reads a file as GPX or as IGC, whichever it begins like. Throws Error(input) naming the file and what is wrong with
/// it, Error(unsupported) for GPX in a build without TERRAY_WITH_TRACKS.
[[nodiscard]] Track readTrack(const std::filesystem::path& path);

}  // namespace terray
