// The only door to pugixml of this folder.
#include <string>

#include "client/exchange/kml_tour.h"
#if TERRAY_WITH_TRACKS
#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>

#include <pugixml.hpp>

#include "client/overlay/xml_names.h"
#endif

namespace terray {

#if TERRAY_WITH_TRACKS

namespace {

/// Where in the document an element is, for messages.
std::string place(const pugi::xml_node& element) {
    return "<" + std::string(element.name()) + "> at byte " + std::to_string(element.offset_debug());
}

/// The child of this name, whatever its prefix.
pugi::xml_node child(const pugi::xml_node& element, std::string_view name) {
    return element.find_child([name](const pugi::xml_node& node) { return localName(node.name()) == name; });
}

/// A number that an element may hold, and what it is where it holds none.
struct Number {
    const char* name;
    double least;
    double most;
    double missing;
};

Result<double> numberOf(const pugi::xml_node& parent, const Number& wanted) {
    const pugi::xml_node node = child(parent, wanted.name);
    if (!node) return wanted.missing;
    const auto value = parseDecimal(node.text().get());
    if (!value || *value < wanted.least || *value > wanted.most)
        return Failure{"at byte " + std::to_string(node.offset_debug()) + " " + wanted.name + " is \"" +
                       node.text().get() + "\", expected " + std::to_string(static_cast<int64_t>(wanted.least)) +
                       " to " + std::to_string(static_cast<int64_t>(wanted.most))};
    return *value;
}

/// KML's default, and what stands for the floor of the sea, is the ground.
Result<KmlAltitude> altitudeMode(const pugi::xml_node& view) {
    const pugi::xml_node node = child(view, "altitudeMode");
    const std::string_view mode = node.text().get();
    if (!node || mode == "clampToGround" || mode == "clampToSeaFloor") return KmlAltitude::ground;
    if (mode == "relativeToGround" || mode == "relativeToSeaFloor") return KmlAltitude::aboveGround;
    if (mode == "absolute") return KmlAltitude::absolute;
    return Failure{place(node) + " is \"" + std::string(mode) +
                   "\", expected absolute, relativeToGround or clampToGround"};
}

Result<KmlView> viewOf(const pugi::xml_node& view, bool isLookAt) {
    constexpr double kMostMetres = 1e8;  // beyond any map of the earth
    const Number wanted[] = {
        {"longitude", -180, 180, NAN}, {"latitude", -90, 90, NAN}, {"altitude", -kMostMetres, kMostMetres, 0},
        {"heading", -360, 360, 0},     {"tilt", 0, 180, 0},        {"range", 0, kMostMetres, 0}};
    double values[std::size(wanted)];
    for (size_t i = 0; i < std::size(wanted); ++i) {
        const auto value = numberOf(view, wanted[i]);
        if (!value) return value.failure();
        if (std::isnan(*value)) return Failure{place(view) + " has no " + wanted[i].name};
        values[i] = *value;
    }
    const auto mode = altitudeMode(view);
    if (!mode) return mode.failure();
    KmlView result{.place = {values[0], values[1]},
                   .altitude = *mode == KmlAltitude::ground ? 0 : values[2],
                   .mode = *mode,
                   .heading = values[3],
                   .tilt = values[4]};
    if (isLookAt) result.range = values[5];
    if (child(view, "horizFov")) {
        const auto fov = numberOf(view, {"horizFov", 0.001, 180, 0});
        if (!fov) return fov.failure();
        result.horizontalFov = *fov;
    }
    return result;
}

Result<KmlStep> stepOf(const pugi::xml_node& element, bool isFlyTo) {
    constexpr double kMostSeconds = 1e6;
    const auto seconds = numberOf(element, {"duration", 0, kMostSeconds, 0});
    if (!seconds) return seconds.failure();
    KmlStep step{.seconds = *seconds};
    if (!isFlyTo) return step;
    step.smooth = std::string_view(child(element, "flyToMode").text().get()) == "smooth";
    const pugi::xml_node camera = child(element, "Camera"), lookAt = child(element, "LookAt");
    if (!camera && !lookAt) return Failure{place(element) + " has neither Camera nor LookAt"};
    auto view = viewOf(camera ? camera : lookAt, !camera);
    if (!view) return view.failure();
    step.view = *view;
    return step;
}

}  // namespace

Result<KmlTour> parseKml(std::string_view bytes) {
    pugi::xml_document document;
    const pugi::xml_parse_result parsed = document.load_buffer(bytes.data(), bytes.size());
    if (!parsed)
        return Failure{"at byte " + std::to_string(parsed.offset) + " it is no XML: " + parsed.description() +
                       "; the file is cut short or damaged"};
    if (localName(document.document_element().name()) != "kml")
        return Failure{"its root element is <" + std::string(document.document_element().name()) + ">, expected <kml>"};
    const pugi::xml_node found =
        document.find_node([](const pugi::xml_node& node) { return localName(node.name()) == "Tour"; });
    if (!found) return Failure{"it has no tour (gx:Tour)"};
    KmlTour tour{.name = child(found, "name").text().get(), .steps = {}};
    bool flies = false;
    for (const pugi::xml_node& element : child(found, "Playlist").children()) {
        const bool isFlyTo = localName(element.name()) == "FlyTo";
        if (!isFlyTo && localName(element.name()) != "Wait") continue;
        auto step = stepOf(element, isFlyTo);
        if (!step) return step.failure();
        flies = flies || isFlyTo;
        tour.steps.push_back(std::move(*step));
    }
    if (!flies) return Failure{place(found) + " flies nowhere (gx:FlyTo in its gx:Playlist)"};
    return tour;
}

#else

Result<KmlTour> parseKml(std::string_view /*bytes*/) {
    return Failure{"this build reads no KML (TERRAY_WITH_TRACKS is off)"};
}

#endif

}  // namespace terray
