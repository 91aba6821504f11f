#pragma once

#include <chrono>
#include <string_view>

#include "common/result.h"

namespace terray {

/// An instant of UTC, counted without leap seconds as std::chrono::system_clock does.
using UtcTime = std::chrono::sys_time<std::chrono::milliseconds>;

/// The instant that a text of ISO 8601 names: "2026-06-21T12:00Z", "2026-06-21T14:00:30.5+02:00".
///
/// Strict: date, "T", hours and minutes; seconds and up to three of their decimals where wanted; then "Z" or an offset
/// "+hh:mm" or "-hh:mm" of at most 14 hours. Years 1900 to 2100 of the Gregorian calendar. Anything else fails and says
/// what is wrong: a time without its zone, a day that its month has not, 24:00, a leap second, "-00:00".
[[nodiscard]] Result<UtcTime> parseUtcTime(std::string_view text);

}  // namespace terray
