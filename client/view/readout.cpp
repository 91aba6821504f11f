#include "client/view/readout.h"

#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace terray {
namespace {

[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...) {
    std::array<char, 160> text{};
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text.data(), text.size(), format, arguments);
    va_end(arguments);
    return text.data();
}

}  // namespace

std::optional<Radians> slopeAt(Ground& ground, glm::dvec2 place, Metres step) {
    const double s = step.value();
    const auto east = ground.under(place + glm::dvec2(s, 0)), west = ground.under(place - glm::dvec2(s, 0));
    const auto north = ground.under(place + glm::dvec2(0, s)), south = ground.under(place - glm::dvec2(0, s));
    if (!east || !west || !north || !south) return {};
    return Radians(std::atan(std::hypot(east->height - west->height, north->height - south->height) / (2 * s)));
}

std::string describePlace(const glm::dvec3& place, const Projection* projection) {
    std::string text;
    if (projection != nullptr)
        if (const auto lonLat = projection->lonLat(glm::dvec2(place)))
            text = formatted("%.6f %c, %.6f %c\n", std::abs(lonLat->latitude), lonLat->latitude < 0 ? 'S' : 'N',
                             std::abs(lonLat->longitude), lonLat->longitude < 0 ? 'W' : 'E');
    return text + formatted("x %.1f, y %.1f\nheight %.1f m", place.x, place.y, place.z);
}

Metres scaleBarLength(Metres longest) {
    const double power = std::pow(10, std::floor(std::log10(longest.value())));
    for (const double factor : {5.0, 2.0})
        if (factor * power <= longest.value()) return Metres(factor * power);
    return Metres(power);
}

std::string lengthText(Metres length) {
    const double metres = length.value();
    if (metres < 10) return formatted("%.3g m", metres);
    if (metres < 1000) return formatted("%.0f m", metres);
    return formatted(metres < 1e5 ? "%.4g km" : "%.0f km", metres / 1000);
}

std::string bytesText(double bytes) {
    constexpr std::array<const char*, 5> kUnits = {"B", "KB", "MB", "GB", "TB"};
    size_t unit = 0;
    for (; bytes >= 1024 && unit + 1 < kUnits.size(); ++unit) bytes /= 1024;
    return formatted(unit == 0 ? "%.0f %s" : "%.1f %s", bytes, kUnits[unit]);
}

}  // namespace terray
