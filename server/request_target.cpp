#include "server/request_target.h"

#include <charconv>

namespace terray::server {
namespace {

std::optional<std::string> unescape(std::string_view text) {
    std::string plain;
    plain.reserve(text.size());
    for (size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            plain += text[i];
            continue;
        }
        unsigned value = 0;
        if (text.size() - i < 3) return {};
        const auto [end, error] = std::from_chars(text.data() + i + 1, text.data() + i + 3, value, 16);
        if (error != std::errc() || end != text.data() + i + 3) return {};
        plain += static_cast<char>(value);
        i += 2;
    }
    return plain;
}

/// The path and query of a target in absolute form; empty when it is none.
std::string_view afterAuthority(std::string_view target) {
    for (const std::string_view scheme : {"http://", "https://"}) {
        if (!target.starts_with(scheme)) continue;
        const size_t path = target.find_first_of("/?", scheme.size());
        return path == std::string_view::npos ? "/" : target.substr(path);
    }
    return {};
}

/// Calls take(part) for each part between separators until it says false. @return whether it never did
template <class Take>
bool forEachPart(std::string_view text, char separator, Take take) {
    for (;;) {
        const size_t end = text.find(separator);
        if (!take(text.substr(0, end))) return false;
        if (end == std::string_view::npos) return true;
        text.remove_prefix(end + 1);
    }
}

}  // namespace

std::optional<RequestTarget> parseTarget(std::string_view target) {
    if (target == "*") return RequestTarget{};
    if (!target.starts_with('/')) target = afterAuthority(target);
    const size_t question = target.find('?');
    std::string_view path = target.substr(0, question);
    if (!path.starts_with('/')) return {};
    path.remove_prefix(1);

    RequestTarget parsed;
    const auto takeSegment = [&](std::string_view text) {
        auto segment = unescape(text);
        if (segment) parsed.segments.push_back(*std::move(segment));
        return segment.has_value();
    };
    if (!path.empty() && !forEachPart(path, '/', takeSegment)) return {};

    const auto takeParameter = [&](std::string_view text) {
        if (parsed.version || !text.starts_with("v=")) return true;
        parsed.version = unescape(text.substr(2));
        return parsed.version.has_value();
    };
    if (question != std::string_view::npos && !forEachPart(target.substr(question + 1), '&', takeParameter)) return {};
    return parsed;
}

}  // namespace terray::server
