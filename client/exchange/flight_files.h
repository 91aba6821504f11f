#pragma once

#include <filesystem>

#include "client/exchange/kml_tour.h"
#include "client/exchange/track_flight.h"
#include "client/stream/flight.h"

namespace terray {

/// A picture's width by its height for which KML's horizontal field of view and ours are the same.
inline constexpr double kKmlAspect = 16.0 / 9;

/// The flight in a file of any of the formats, told apart by content: Terray's JSON, a KML tour, a GPX or IGC track.
///
/// @param projection  of the dataset; null: it has none, and only JSON can be read
/// @param ground      where heights are missing or count from the ground
/// Throws Error(input) naming the file and what is wrong with it, Error(georeference) for a track or tour without
/// projection, Error(unsupported) for KML and GPX in a build without TERRAY_WITH_TRACKS.
[[nodiscard]] Flight importFlight(const std::filesystem::path& path, const TrackFlightOptions& track,
                                  const Projection* projection, GroundHeights& ground);

/// Writes a flight in the format that the name's ending says: .json, .kml (a tour of smooth gx:FlyTo with absolute
/// cameras, which importFlight gives back to 1 mm and 2e-6 degrees) or .gpx (a track, a point at each key and at least
/// one a second, times from 2000-01-01T00:00:00Z). Throws Error(usage) for another ending, Error(georeference) for KML
/// and GPX without projection or outside of it, Error(output) when it cannot be written.
void exportFlight(const Flight& flight, const std::filesystem::path& path, const Projection* projection);

/// The flight of a tour, named and timed as it is, its first view at second 0. A gx:Wait, and the end of each gx:FlyTo
/// that is not smooth, is a rest; arcs of the latter are not flown. 45 degrees of field of view unless the tour says.
/// Heights above ground, and views clamped to it, count from the dataset's; beyond it from its lowest. Fails where a
/// place is not in the projection.
[[nodiscard]] Result<Flight> flightOf(const KmlTour& tour, const Projection& projection, GroundHeights& ground);
/// The inverse. Fails where a place is not in the projection.
[[nodiscard]] Result<KmlTour> tourOf(const Flight& flight, const Projection& projection);

}  // namespace terray
