#include "client/render/shading.h"

#include <cmath>
#include <cstdio>

namespace terray {
namespace {

std::string shortText(double value) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.6g", value);
    return text;
}

}  // namespace

ShadingNeeds needsOf(Shading shading) {
    switch (shading) {
        case Shading::photo:
            return {.photo = true, .photoTiles = true, .light = true};
        case Shading::light:
        case Shading::level:
        case Shading::tiles:
            return {.light = true};
        case Shading::height:
        case Shading::error:
            return {.light = true, .measures = true};
        case Shading::grid:
            return {.light = true, .footprint = true};
        case Shading::contours:
            return {.light = true, .footprint = true, .measures = true};
        case Shading::residency:
            return {.photoTiles = true, .light = true};
        case Shading::depth:
        case Shading::normal:
        case Shading::slope:
            return {};
        case Shading::steps:
            return {.sky = false, .steps = true};
        case Shading::shadowSteps:
            return {.sky = false, .shadowSteps = true};
        case Shading::sobel:
            return {.photo = true, .photoTiles = true};
    }
    return {};
}

Metres automaticContourInterval(Metres lowest, Metres highest) {
    constexpr double kLeastLines = 20;
    const double most = (highest.value() - lowest.value()) / kLeastLines;
    if (!(most > 0)) return Metres(1);
    const double decade = std::pow(10, std::floor(std::log10(most)));
    const double multiple = most / decade;
    return Metres(decade * (multiple >= 5 ? 5 : multiple >= 2 ? 2 : 1));
}

std::string description(const ShadingOptions& shading) {
    std::string text(kShadingModes.at(static_cast<size_t>(shading.mode)).name);
    if (shading.mode == Shading::height)
        text += ", from " + shortText(shading.lowest.value()) + " to " + shortText(shading.highest.value()) + " m";
    if (shading.mode == Shading::contours) {
        const double interval = shading.contourInterval.value();
        text += ", every " + shortText(interval) + " m, stronger every " + shortText(5 * interval) + " m";
    }
    if (shading.mode == Shading::error)
        text += ", against a tolerance of " + shortText(shading.tolerance.value()) + " pixels";
    return text;
}

}  // namespace terray
