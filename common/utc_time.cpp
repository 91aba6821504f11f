#include "common/utc_time.h"

#include <optional>
#include <string>

namespace terray {
namespace {

constexpr int kFirstYear = 1900;
constexpr int kLastYear = 2100;
constexpr int kMostOffsetMinutes = 14 * 60;  // Kiribati; the least is -12 h

/// Takes the text from its front, piece by piece.
class Reader {
  public:
    explicit Reader(std::string_view text) : rest_(text) {}

    /// A number of exactly so many digits.
    std::optional<int> digits(size_t count) {
        if (rest_.size() < count) return {};
        int value = 0;
        for (const char c : rest_.substr(0, count)) {
            if (c < '0' || c > '9') return {};
            value = 10 * value + (c - '0');
        }
        rest_.remove_prefix(count);
        return value;
    }
    bool take(char c) {
        if (rest_.empty() || rest_.front() != c) return false;
        rest_.remove_prefix(1);
        return true;
    }
    /// Up to three decimals as thousandths; none when there is no digit.
    std::optional<int> thousandths() {
        int value = 0;
        size_t taken = 0;
        for (; taken < 3; ++taken) {
            const std::optional<int> digit = digits(1);
            if (!digit) break;
            value = 10 * value + *digit;
        }
        if (taken == 0) return {};
        for (; taken < 3; ++taken) value *= 10;
        return value;
    }
    [[nodiscard]] bool atEnd() const { return rest_.empty(); }

  private:
    std::string_view rest_;
};

std::optional<std::chrono::year_month_day> takeDate(Reader& reader) {
    const auto year = reader.digits(4);
    if (!year || !reader.take('-')) return {};
    const auto month = reader.digits(2);
    if (!month || !reader.take('-')) return {};
    const auto day = reader.digits(2);
    if (!day) return {};
    return std::chrono::year_month_day(std::chrono::year(*year), std::chrono::month(static_cast<unsigned>(*month)),
                                       std::chrono::day(static_cast<unsigned>(*day)));
}

struct ClockTime {
    int hour = 0;
    int minute = 0;
    int second = 0;
    int thousandths = 0;
};

std::optional<ClockTime> takeClockTime(Reader& reader) {
    const auto hour = reader.digits(2);
    if (!hour || !reader.take(':')) return {};
    const auto minute = reader.digits(2);
    if (!minute) return {};
    ClockTime time{.hour = *hour, .minute = *minute};
    if (!reader.take(':')) return time;
    const auto second = reader.digits(2);
    if (!second) return {};
    time.second = *second;
    if (!reader.take('.')) return time;
    const auto thousandths = reader.thousandths();
    if (!thousandths) return {};
    time.thousandths = *thousandths;
    return time;
}

/// Minutes that local time is ahead of UTC.
std::optional<int> takeOffset(Reader& reader) {
    if (reader.take('Z')) return 0;
    const bool behind = reader.take('-');
    if (!behind && !reader.take('+')) return {};
    const auto hours = reader.digits(2);
    if (!hours || !reader.take(':')) return {};
    const auto minutes = reader.digits(2);
    if (!minutes || *minutes > 59) return {};
    const int total = 60 * *hours + *minutes;
    if (total > kMostOffsetMinutes || (behind && total == 0)) return {};
    return behind ? -total : total;
}

}  // namespace

Result<UtcTime> parseUtcTime(std::string_view text) {
    const auto refuse = [&](const std::string& why) {
        return Failure{"found \"" + std::string(text) +
                       "\", expected a time as 2026-06-21T12:00Z or 2026-06-21T14:00:30+02:00: " + why};
    };
    Reader reader(text);
    const auto date = takeDate(reader);
    if (!date) return refuse("the date is not YYYY-MM-DD");
    const auto year = static_cast<int>(date->year());
    if (year < kFirstYear || year > kLastYear) {
        return refuse("the year is not within " + std::to_string(kFirstYear) + " to " + std::to_string(kLastYear));
    }
    if (!date->ok()) return refuse("the calendar has no such day");
    if (!reader.take('T')) return refuse("no T stands between date and time of day");
    const auto time = takeClockTime(reader);
    if (!time) return refuse("the time of day is not hh:mm, hh:mm:ss or hh:mm:ss.sss");
    if (time->hour > 23 || time->minute > 59 || time->second > 59) return refuse("the day has no such time");
    const auto offset = takeOffset(reader);
    if (!offset) return refuse("no zone follows the time: Z, or an offset from -14:00 to +14:00");
    if (!reader.atEnd()) return refuse("something follows the zone");

    return UtcTime(std::chrono::sys_days(*date)) + std::chrono::hours(time->hour) +
           std::chrono::minutes(time->minute - *offset) + std::chrono::seconds(time->second) +
           std::chrono::milliseconds(time->thousandths);
}

}  // namespace terray
