#include "client/exchange/kml_tour.h"
#include "client/exchange/xml_text.h"
#include "common/json.h"

namespace terray {
namespace {

std::string element(const std::string& name, const std::string& content) {
    return "<" + name + ">" + content + "</" + name + ">";
}

std::string element(const std::string& name, double number) {
    return element(name, Json(number).dump(0));
}

std::string textOf(const KmlView& view) {
    const char* kind = view.range ? "LookAt" : "Camera";
    std::string text = std::string("<") + kind + ">";
    if (view.horizontalFov) text += element("gx:horizFov", *view.horizontalFov);
    text += element("longitude", view.place.longitude) + element("latitude", view.place.latitude) +
            element("altitude", view.altitude) + element("heading", view.heading) + element("tilt", view.tilt);
    if (view.range) text += element("range", *view.range);
    const char* mode = view.mode == KmlAltitude::absolute      ? "absolute"
                       : view.mode == KmlAltitude::aboveGround ? "relativeToGround"
                                                               : "clampToGround";
    return text + element("altitudeMode", mode) + "</" + kind + ">";
}

std::string textOf(const KmlStep& step) {
    const std::string duration = element("gx:duration", step.seconds);
    if (!step.view) return element("gx:Wait", duration);
    return element("gx:FlyTo",
                   duration + element("gx:flyToMode", step.smooth ? "smooth" : "bounce") + textOf(*step.view));
}

}  // namespace

std::string toKml(const KmlTour& tour) {
    std::string text =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<kml xmlns=\"http://www.opengis.net/kml/2.2\" xmlns:gx=\"http://www.google.com/kml/ext/2.2\">\n"
        "<gx:Tour>" +
        element("name", xmlText(tour.name)) + "<gx:Playlist>\n";
    for (const KmlStep& step : tour.steps) text += textOf(step) + "\n";
    return text + "</gx:Playlist></gx:Tour>\n</kml>\n";
}

}  // namespace terray
