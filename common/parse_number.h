#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <system_error>

namespace terray {

/// The finite number that all of a text is, written as in C++ ("-1.5e3", no blanks, no "+"); none for any other text.
/// The same in every locale.
[[nodiscard]] inline std::optional<double> parseNumber(std::string_view text) {
    double value = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec != std::errc() || result.ptr != text.data() + text.size() || !std::isfinite(value)) return {};
    return value;
}

}  // namespace terray
