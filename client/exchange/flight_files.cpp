#include "client/exchange/flight_files.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <span>
#include <string>

#include "client/exchange/xml_text.h"
#include "common/error.h"
#include "common/output_file.h"

namespace terray {
namespace {

Error refusal(const std::filesystem::path& path, const std::string& why) {
    return {ExitCode::input, "cannot read a flight from " + path.string() + ": " + why};
}

std::string beginningOf(const std::filesystem::path& path) {
    constexpr size_t kEnough = 4096;  // of comments and declarations before the root element
    std::ifstream file(path, std::ios::binary);
    if (!file) throw refusal(path, "it cannot be opened");
    std::string text(kEnough, '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<size_t>(file.gcount()));
    return text;
}

const Projection& needed(const Projection* projection, const std::filesystem::path& path) {
    if (projection == nullptr)
        throw Error(ExitCode::georeference, path.string() +
                                                " has longitudes and latitudes, but the dataset has no coordinate "
                                                "system that this build can use; give a flight in JSON");
    return *projection;
}

Flight importTour(const std::filesystem::path& path, const Projection& projection, GroundHeights& ground) {
    if (!TERRAY_WITH_TRACKS)
        throw Error(ExitCode::unsupported,
                    "cannot read " + path.string() + ": this build reads no KML (TERRAY_WITH_TRACKS is off)");
    const auto tour = parseKml(readTrackFile(path));
    if (!tour) throw refusal(path, tour.failure().message);
    auto flight = flightOf(*tour, projection, ground);
    if (!flight) throw refusal(path, flight.failure().message);
    return std::move(*flight);
}

Flight importTrack(const std::filesystem::path& path, const TrackFlightOptions& options, const Projection& projection,
                   GroundHeights& ground) {
    auto flight = flightAlong(readTrack(path), options, projection, ground);
    if (!flight) throw refusal(path, flight.failure().message);
    flight->name = path.stem().string();
    return std::move(*flight);
}

/// 2000-01-01T00:00:00Z and so many seconds later.
std::string timeText(double seconds) {
    using namespace std::chrono;
    const auto thousandths = milliseconds(std::llround(seconds * 1000));
    const auto day = floor<days>(thousandths);
    const year_month_day date(sys_days(year(2000) / 1 / 1) + day);
    const hh_mm_ss<milliseconds> time(thousandths - day);
    char text[64];
    std::snprintf(text, sizeof(text), "%04d-%02u-%02uT%02d:%02d:%02d.%03dZ", static_cast<int>(date.year()),
                  static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                  static_cast<int>(time.hours().count()), static_cast<int>(time.minutes().count()),
                  static_cast<int>(time.seconds().count()), static_cast<int>(time.subseconds().count()));
    return text;
}

Result<std::string> pointText(const Flight& flight, double seconds, const Projection& projection) {
    const glm::dvec3 position = flight.at(seconds).position;
    const auto place = projection.lonLat(glm::dvec2(position));
    if (!place) return place.failure();
    return "<trkpt lat=\"" + Json(place->latitude).dump(0) + "\" lon=\"" + Json(place->longitude).dump(0) + "\"><ele>" +
           Json(position.z).dump(0) + "</ele><time>" + timeText(seconds) + "</time></trkpt>\n";
}

Result<std::string> gpxOf(const Flight& flight, const Projection& projection) {
    std::string text =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<gpx version=\"1.1\" creator=\"Terray\" xmlns=\"http://www.topografix.com/GPX/1/1\">\n<trk><name>" +
        xmlText(flight.name) + "</name><trkseg>\n";
    for (size_t key = 0; key < flight.keys.size(); ++key) {
        const double start = flight.keys[key].seconds;
        const double span = key + 1 < flight.keys.size() ? flight.keys[key + 1].seconds - start : 0;
        const auto points = std::max(std::ceil(span), 1.0);
        for (double n = 0; n < points; ++n) {
            const auto point = pointText(flight, start + span * n / points, projection);
            if (!point) return point.failure();
            text += *point;
        }
    }
    return text + "</trkseg></trk>\n</gpx>\n";
}

Result<std::string> kmlOf(const Flight& flight, const Projection& projection) {
    const auto tour = tourOf(flight, projection);
    if (!tour) return tour.failure();
    return toKml(*tour);
}

}  // namespace

Flight importFlight(const std::filesystem::path& path, const TrackFlightOptions& track, const Projection* projection,
                    GroundHeights& ground) {
    const std::string beginning = beginningOf(path);
    if (beginning.starts_with("PK"))
        throw refusal(path, "it is an archive (KMZ?); unpack it and give the KML file in it, mostly doc.kml");
    const size_t first = beginning.find_first_not_of(" \t\r\n");
    if (first != std::string::npos && beginning[first] == '{') return loadFlight(path);
    if (beginning.find("<kml") != std::string::npos || beginning.find(":kml") != std::string::npos)
        return importTour(path, needed(projection, path), ground);
    return importTrack(path, track, needed(projection, path), ground);
}

void exportFlight(const Flight& flight, const std::filesystem::path& path, const Projection* projection) {
    const std::string ending = path.extension().string();
    if (ending == ".json") return saveFlight(flight, path, projection);
    if (ending != ".kml" && ending != ".gpx")
        throw Error(ExitCode::usage, "cannot tell a format for a flight from the name " + path.string() +
                                         ", expected one that ends in .json, .kml or .gpx");
    if (projection == nullptr)
        throw Error(ExitCode::georeference,
                    "cannot write " + path.string() + ": the dataset has no coordinate system that this build can use");
    const auto text = ending == ".kml" ? kmlOf(flight, *projection) : gpxOf(flight, *projection);
    if (!text) throw Error(ExitCode::georeference, "cannot write " + path.string() + ": " + text.failure().message);
    writeWholeFile(path, std::as_bytes(std::span(*text)));
}

}  // namespace terray
