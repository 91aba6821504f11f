#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "client/stream/camera.h"
#include "client/stream/dataset_source.h"
#include "common/json.h"

namespace terray {

/// Later than this no key of a flight is.
inline constexpr double kMostFlightSeconds = 1e9;

/// A camera at a time.
struct FlightKey {
    double seconds = 0;  ///< from the flight's start, ascending
    Camera camera;
    bool operator==(const FlightKey&) const = default;
};

/// A recorded or planned path of the camera. Between keys position and angles follow a monotone-time Catmull-Rom spline
/// (centripetal is not needed: times are given), headings the shorter way round; before the first and after the last
/// key the camera rests. Exact at the keys.
struct Flight {
    std::string dataset;  ///< name of the dataset it was made for, for people
    std::string name;
    std::vector<FlightKey> keys;
    bool operator==(const Flight&) const = default;

    [[nodiscard]] double seconds() const { return keys.empty() ? 0 : keys.back().seconds; }
    [[nodiscard]] Camera at(double seconds) const;
};

/// Pictures of a flight at a fixed rate: frame n is at n / rate, and the last one is the last that does not lie beyond
/// the end. @param framesPerSecond  > 0
[[nodiscard]] size_t frameCount(const Flight& flight, double framesPerSecond);

/// JSON as documented in client/README.md: positions in dataset coordinates, longitude, latitude and degrees beside
/// them when a projection is given (they are for people; reading takes the dataset coordinates).
[[nodiscard]] Json toJson(const Flight& flight, const Projection* projection);
[[nodiscard]] Result<Flight> flightFromJson(const Json& json);
/// The nearest pose that such JSON gives back bit by bit: angles, which it holds in degrees, move by 1e-15 of
/// themselves at most. Pitch must be -pi/2 .. pi/2.
[[nodiscard]] Camera asWritten(const Camera& camera);
/// Throws Error(input) when the file is missing or no flight, Error(output) when it cannot be written.
[[nodiscard]] Flight loadFlight(const std::filesystem::path& path);
void saveFlight(const Flight& flight, const std::filesystem::path& path, const Projection* projection);

/// Standard flights; client/README.md tells what each is for.
enum class TourKind { standard, takeOff, lowPass, climb, lookDown, horizonSweep, fastDash };

/// A standard flight's name on the command line.
struct TourKindName {
    TourKind kind;
    std::string_view name;
};
inline constexpr TourKindName kTourKinds[] = {
    {TourKind::standard, "standard"},  {TourKind::takeOff, "take-off"},   {TourKind::lowPass, "low-pass"},
    {TourKind::climb, "climb"},        {TourKind::lookDown, "look-down"}, {TourKind::horizonSweep, "horizon-sweep"},
    {TourKind::fastDash, "fast-dash"},
};

/// A flight derived from a dataset's extent and heights, so that runs on one dataset compare.
///
/// The standard one: an overview from outside with all of the ground across a 16:9 picture, a descent, a low pass over
/// rough ground looking ahead, a turn, a climb, a look straight down, the dataset's edge from low height, a sweep of
/// the horizon. Ground without large holes and at most twice as long as wide fills at least 15 % of such a picture at
/// any time. The camera of every kind stays above the ground it flies over by a clearance taken from the data: at least
/// 0.6 % of the extent (checked 30 times a second of the flight). `dataset` is left empty for the caller to name it.
/// Reads up to five coarse tiles; throws Error(dataset) when one is damaged. @param seconds  > 0
[[nodiscard]] Flight standardTour(const TileSource& source, double seconds, TourKind kind = TourKind::standard);

}  // namespace terray
