#pragma once

#include <optional>
#include <string_view>

#include "common/parse_number.h"

namespace terray {

/// An element's name without its namespace's prefix.
[[nodiscard]] inline std::string_view localName(std::string_view qualified) {
    const size_t colon = qualified.find(':');
    return colon == std::string_view::npos ? qualified : qualified.substr(colon + 1);
}

/// A decimal of XML Schema: blanks around it and a plus before it are allowed.
[[nodiscard]] inline std::optional<double> parseDecimal(std::string_view text) {
    const size_t first = text.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos) return {};
    text = text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
    if (text.starts_with('+')) text.remove_prefix(1);
    return parseNumber(text);
}

}  // namespace terray
