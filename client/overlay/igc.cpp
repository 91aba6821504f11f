#include <charconv>
#include <string>

#include "client/overlay/track.h"

namespace terray {
namespace {

/// A number of digits only, as long as the text.
std::optional<int> parseDigits(std::string_view text) {
    int value = 0;
    for (const char c : text) {
        if (c < '0' || c > '9') return {};
        value = 10 * value + (c - '0');
    }
    return value;
}

/// Degrees and thousandths of minutes, "4612345N" or "00712345E", `degreeDigits` digits of them degrees.
std::optional<double> parseAngle(std::string_view text, size_t degreeDigits, char positive, char negative, int most) {
    const auto degrees = parseDigits(text.substr(0, degreeDigits));
    const auto minutes = parseDigits(text.substr(degreeDigits, 5));
    const char side = text.back();
    if (!degrees || !minutes || *minutes >= 60'000 || (side != positive && side != negative)) return {};
    const double angle = *degrees + *minutes / 60'000.0;
    if (angle > most) return {};
    return side == positive ? angle : -angle;
}

/// Seconds of the day, "101230".
std::optional<double> parseTime(std::string_view text) {
    const auto hours = parseDigits(text.substr(0, 2)), minutes = parseDigits(text.substr(2, 2)),
               seconds = parseDigits(text.substr(4, 2));
    if (!hours || !minutes || !seconds || *hours > 23 || *minutes > 59 || *seconds > 59) return {};
    return 3600 * *hours + 60 * *minutes + *seconds;
}

/// Five characters of metres; the first may be a minus.
std::optional<int> parseHeight(std::string_view text) {
    const bool negative = text.front() == '-';
    const auto digits = parseDigits(negative ? text.substr(1) : text);
    if (!digits) return {};
    return negative ? -*digits : *digits;
}

// Columns of a B record: B HHMMSS DDMMmmmN DDDMMmmmE V PPPPP GGGGG
constexpr size_t kTime = 1;
constexpr size_t kLatitude = 7;
constexpr size_t kLongitude = 15;
constexpr size_t kValidity = 24;
constexpr size_t kBarometric = 25;
constexpr size_t kGnss = 30;
constexpr size_t kFixLength = 35;

Result<TrackPoint> parseFix(std::string_view line) {
    if (line.size() < kFixLength)
        return Failure{"has " + std::to_string(line.size()) + " characters, expected at least " +
                       std::to_string(kFixLength) + "; the file is cut short or damaged"};
    const auto time = parseTime(line.substr(kTime, 6));
    if (!time) return Failure{"has time \"" + std::string(line.substr(kTime, 6)) + "\", expected as 235959"};
    const auto latitude = parseAngle(line.substr(kLatitude, 8), 2, 'N', 'S', 90);
    if (!latitude)
        return Failure{"has latitude \"" + std::string(line.substr(kLatitude, 8)) + "\", expected as 4612345N"};
    const auto longitude = parseAngle(line.substr(kLongitude, 9), 3, 'E', 'W', 180);
    if (!longitude)
        return Failure{"has longitude \"" + std::string(line.substr(kLongitude, 9)) + "\", expected as 00712345E"};
    const char validity = line[kValidity];
    if (validity != 'A' && validity != 'V')
        return Failure{std::string("has validity \"") + validity + "\", expected A or V"};
    const size_t column = validity == 'A' ? kGnss : kBarometric;
    const auto height = parseHeight(line.substr(column, 5));
    if (!height)
        return Failure{"has height \"" + std::string(line.substr(column, 5)) + "\", expected as 01234 or -0012"};
    return TrackPoint{.place = {.longitude = *longitude, .latitude = *latitude}, .height = *height, .seconds = time};
}

}  // namespace

Result<Track> parseIgc(std::string_view bytes) {
    std::vector<TrackPoint> points;
    int number = 0;
    while (!bytes.empty()) {
        ++number;
        const size_t end = bytes.find_first_of("\r\n");
        const std::string_view line = bytes.substr(0, end);
        const bool pair = end != std::string_view::npos && bytes.substr(end, 2) == "\r\n";
        bytes.remove_prefix(end == std::string_view::npos ? bytes.size() : end + (pair ? 2 : 1));
        if (!line.starts_with('B')) continue;
        const auto point = parseFix(line);
        if (!point) return Failure{"line " + std::to_string(number) + " " + point.failure().message};
        points.push_back(*point);
        // The clock has no date: a flight over midnight UTC goes on in the next day.
        constexpr double kDay = 86400;
        if (points.size() > 1)
            while (*points.back().seconds < *points.end()[-2].seconds - kDay / 2) *points.back().seconds += kDay;
    }
    if (points.empty()) return Failure{"it holds no fix (B record)"};
    return Track{{std::move(points)}};
}

}  // namespace terray
