// The only door to pugixml.
#include <chrono>
#include <string>

#include "client/overlay/track.h"
#if TERRAY_WITH_TRACKS
#include <pugixml.hpp>

#include "client/overlay/xml_names.h"
#include "common/utc_time.h"
#endif

namespace terray {

#if TERRAY_WITH_TRACKS

namespace {

/// Seconds since 1970; decimals beyond the third do not matter.
std::optional<double> parseTime(std::string text) {
    const size_t point = text.find('.');
    if (point != std::string::npos) {
        const size_t end = std::min(text.find_first_not_of("0123456789", point + 1), text.size());
        if (end > point + 4) text.erase(point + 4, end - point - 4);
    }
    const auto time = parseUtcTime(text);
    if (!time) return {};
    return std::chrono::duration<double>(time->time_since_epoch()).count();
}

Result<double> parseAngle(const pugi::xml_node& point, const char* attribute, double most) {
    const std::string_view text = point.attribute(attribute).value();
    const auto value = parseDecimal(text);
    if (!value || std::abs(*value) > most)
        return Failure{std::string(attribute) + " is \"" + std::string(text) + "\", expected -" +
                       std::to_string(static_cast<int>(most)) + " to " + std::to_string(static_cast<int>(most)) +
                       " degrees"};
    return *value;
}

Result<TrackPoint> parsePoint(const pugi::xml_node& point) {
    const auto latitude = parseAngle(point, "lat", 90);
    if (!latitude) return latitude.failure();
    const auto longitude = parseAngle(point, "lon", 180);
    if (!longitude) return longitude.failure();
    TrackPoint result{.place = {.longitude = *longitude, .latitude = *latitude}, .height = {}};
    for (const pugi::xml_node& child : point.children()) {
        if (localName(child.name()) == "time") result.seconds = parseTime(child.text().get());
        if (localName(child.name()) != "ele") continue;
        result.height = parseDecimal(child.text().get());
        constexpr double kMost = 1e8;  // metres: beyond any map of the earth
        if (!result.height || std::abs(*result.height) > kMost)
            return Failure{std::string("ele is \"") + child.text().get() + "\", expected metres"};
    }
    return result;
}

/// Adds the points of a segment or a route to a track as one line. @param pointName  "trkpt" or "rtept"
Result<void> addLine(const pugi::xml_node& parent, std::string_view pointName, Track& track) {
    std::vector<TrackPoint> line;
    for (const pugi::xml_node& child : parent.children()) {
        if (localName(child.name()) != pointName) continue;
        const auto point = parsePoint(child);
        if (!point)
            return Failure{"at byte " + std::to_string(child.offset_debug()) + " a point's " + point.failure().message};
        line.push_back(*point);
    }
    if (!line.empty()) track.lines.push_back(std::move(line));
    return {};
}

Result<void> addTrack(const pugi::xml_node& element, Track& track) {
    for (const pugi::xml_node& segment : element.children()) {
        if (localName(segment.name()) != "trkseg") continue;
        if (auto added = addLine(segment, "trkpt", track); !added) return added;
    }
    return {};
}

}  // namespace

Result<Track> parseGpx(std::string_view bytes) {
    pugi::xml_document document;
    const pugi::xml_parse_result parsed = document.load_buffer(bytes.data(), bytes.size());
    if (!parsed)
        return Failure{"at byte " + std::to_string(parsed.offset) + " it is no XML: " + parsed.description() +
                       "; the file is cut short or damaged"};
    const pugi::xml_node root = document.document_element();
    if (localName(root.name()) != "gpx")
        return Failure{"its root element is <" + std::string(root.name()) + ">, expected <gpx>"};
    Track track;
    for (const pugi::xml_node& child : root.children()) {
        Result<void> added;
        if (localName(child.name()) == "trk") added = addTrack(child, track);
        if (localName(child.name()) == "rte") added = addLine(child, "rtept", track);
        if (!added) return added.failure();
    }
    if (track.lines.empty()) return Failure{"it holds no point of a track or route (trkpt, rtept)"};
    return track;
}

#else

Result<Track> parseGpx(std::string_view /*bytes*/) {
    return Failure{"this build reads no GPX (TERRAY_WITH_TRACKS is off)"};
}

#endif

}  // namespace terray
