#pragma once

#include <string>
#include <string_view>

namespace terray {

/// A text as it stands between two tags: markup escaped, characters that XML 1.0 forbids as "?".
[[nodiscard]] inline std::string xmlText(std::string_view text) {
    std::string safe;
    for (const char c : text) {
        const bool forbidden = static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r';
        if (c == '&')
            safe += "&amp;";
        else if (c == '<')
            safe += "&lt;";
        else if (c == '>')
            safe += "&gt;";
        else
            safe += forbidden ? '?' : c;
    }
    return safe;
}

}  // namespace terray
