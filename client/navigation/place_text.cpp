#include "client/navigation/place_text.h"

#include <cmath>
#include <locale>
#include <sstream>

namespace terray {

Result<glm::dvec2> parsePlace(const std::string& text, const Projection* projection) {
    std::string spaced = text;
    for (char& letter : spaced)
        if (letter == ',' || letter == ';') letter = ' ';
    std::istringstream words(spaced);
    words.imbue(std::locale::classic());
    double first = 0, second = 0;
    std::string rest;
    constexpr double kFarthest = 1e8;  // metres: beyond any map of the earth
    if (!(words >> first >> second) || words >> rest || !(std::abs(first) <= kFarthest) ||
        !(std::abs(second) <= kFarthest))
        return Failure{"found \"" + text +
                       "\", expected two numbers: latitude, longitude in degrees or x, y in metres"};
    if (projection != nullptr && std::abs(first) <= 90 && std::abs(second) <= 180)
        return projection->plane({.longitude = second, .latitude = first});
    return glm::dvec2(first, second);
}

}  // namespace terray
