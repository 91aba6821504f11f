#include "client/engine/overlay_options.h"

#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "client/engine/dataset_camera.h"
#include "client/overlay/ground_heights.h"
#include "client/overlay/shapes.h"
#include "client/overlay/track.h"
#include "common/error.h"
#include "common/parse_number.h"

namespace terray {
namespace {

// Linear colours that differ from ground, snow, woods and sky.
constexpr glm::vec3 kMarkerColour(0.80f, 0.03f, 0.03f);
constexpr glm::vec3 kCubeColour(0.85f, 0.30f, 0.02f);
constexpr std::array<glm::vec3, 4> kTrackColours = {glm::vec3(0.85f, 0.06f, 0.02f), glm::vec3(0.02f, 0.12f, 0.80f),
                                                    glm::vec3(0.75f, 0.02f, 0.55f), glm::vec3(0.90f, 0.55f, 0.01f)};
constexpr double kMarkerHeight = 30;   // metres, as a tall tree
constexpr double kMarkerPixels = 24;   // and never smaller on the screen than a map's pin
constexpr double kTrackPixels = 1.25;  // half the width of a thin line
constexpr double kMostMetres = 1e8;    // beyond any map of the earth

std::vector<double> parseNumbers(const std::string& option, const std::string& text, const char* form, size_t least,
                                 size_t most) {
    std::vector<double> numbers;
    const auto refuse = [&] {
        return Error(ExitCode::usage, option + ": found \"" + text + "\", expected " + form + " in degrees and metres");
    };
    for (std::string_view rest = text;;) {
        const size_t comma = rest.find(',');
        const auto number = parseNumber(rest.substr(0, comma));
        if (!number || std::abs(*number) > kMostMetres) throw refuse();
        numbers.push_back(*number);
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
    }
    if (numbers.size() < least || numbers.size() > most) throw refuse();
    return numbers;
}

/// From places as people give them to the dataset's world.
class Places {
  public:
    Places(const TileSource& source, const EditList& edits)
        : projection_(projectionOf(source.metadata())), ground_(source, edits) {}

    [[nodiscard]] bool hasCoordinateSystem() const { return projection_.has_value(); }

    /// @param what  for messages, such as "--marker 7.5,46.2"
    glm::dvec3 at(double x, double y, std::optional<double> height, const std::string& what) {
        const glm::dvec2 place = projection_ ? planeOf({x, y}, what) : glm::dvec2(x, y);
        if (!height) height = ground_.at(place);
        if (!height)
            throw Error(ExitCode::georeference,
                        what + ": there is no ground of the dataset to stand on; give a height, or a place within it");
        return {place, *height};
    }

  private:
    glm::dvec2 planeOf(LonLat place, const std::string& what) {
        if (std::abs(place.longitude) > 180 || std::abs(place.latitude) > 90)
            throw Error(ExitCode::usage,
                        what + ": expected a longitude of -180 to 180 and a latitude of -90 to 90 degrees");
        const auto plane = projection_->plane(place);
        if (!plane) throw Error(ExitCode::georeference, what + ": " + plane.failure().message);
        return *plane;
    }

    std::optional<Projection> projection_;
    GroundHeights ground_;
};

OverlayMesh trackMesh(const std::string& path, Places& places, double radius, const glm::vec3& colour) {
    if (!places.hasCoordinateSystem())
        throw Error(TERRAY_WITH_PROJ ? ExitCode::georeference : ExitCode::unsupported,
                    "--track " + path + ": a track has longitudes and latitudes, and " +
                        (TERRAY_WITH_PROJ ? "the dataset has no coordinate system"
                                          : "this build cannot convert them (TERRAY_WITH_PROJ is off)"));
    std::vector<std::vector<glm::dvec3>> lines;
    for (const std::vector<TrackPoint>& line : readTrack(path).lines) {
        std::vector<glm::dvec3>& world = lines.emplace_back();
        for (const TrackPoint& point : line)
            world.push_back(places.at(point.place.longitude, point.place.latitude, point.height, "--track " + path));
    }
    return tubeMesh(lines, {.radius = radius, .leastPixels = kTrackPixels, .colour = colour});
}

OverlayMesh markerMesh(const std::string& text, Places& places) {
    const std::vector<double> numbers = parseNumbers("--marker", text, "LON,LAT[,HEIGHT]", 2, 3);
    const auto height = numbers.size() == 3 ? std::optional(numbers[2]) : std::nullopt;
    OverlayMesh mesh =
        pinMesh(places.at(numbers[0], numbers[1], height, "--marker " + text), kMarkerHeight, kMarkerColour);
    mesh.leastPixels = kMarkerPixels;
    return mesh;
}

OverlayMesh boxMesh(const std::string& text, Places& places) {
    const std::vector<double> numbers = parseNumbers("--cube", text, "LON,LAT,HEIGHT,SIDE", 4, 4);
    if (numbers[3] <= 0) throw Error(ExitCode::usage, "--cube " + text + ": expected a SIDE above 0 metres");
    return cubeMesh(places.at(numbers[0], numbers[1], numbers[2], "--cube " + text), numbers[3], kCubeColour);
}

Json listOf(const std::vector<std::string>& values) {
    return Json::Array(values.begin(), values.end());
}

}  // namespace

void OverlayCommandLine::declare(CommandLine& line) {
    line.list("--track", tracks_, "FILE", "draw GPX or IGC tracks as tubes; on the ground where they have no heights");
    line.option("--track-radius", trackRadius_, "METRES", "of tracks, 0.01 to 10000; thicker from afar (5)");
    line.list("--marker", markers_, "LON,LAT[,HEIGHT]", "draw pins, on the ground where no height is given");
    line.list("--cube", cubes_, "LON,LAT,HEIGHT,SIDE", "draw cubes, HEIGHT of the lowest face, in metres");
}

std::vector<OverlayMesh> OverlayCommandLine::meshes(const TileSource& source, const EditList& edits) const {
    if (!(trackRadius_ >= 0.01 && trackRadius_ <= 10000))
        throw Error(ExitCode::usage, "--track-radius: found \"" + Json(trackRadius_).dump() +
                                         "\", expected a number from 0.01 to 10000");
    if (tracks_.empty() && markers_.empty() && cubes_.empty()) return {};
    Places places(source, edits);
    std::vector<OverlayMesh> result;
    for (size_t i = 0; i < tracks_.size(); ++i)
        result.push_back(trackMesh(tracks_[i], places, trackRadius_, kTrackColours[i % kTrackColours.size()]));
    for (const std::string& text : markers_) result.push_back(markerMesh(text, places));
    for (const std::string& text : cubes_) result.push_back(boxMesh(text, places));
    return result;
}

Json OverlayCommandLine::toJson() const {
    return Json::Object{{"track", listOf(tracks_)},
                        {"track-radius", trackRadius_},
                        {"marker", listOf(markers_)},
                        {"cube", listOf(cubes_)}};
}

}  // namespace terray
