#include "server/preconditions.h"

#include <algorithm>
#include <limits>

namespace terray::server {
namespace {

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
    return text;
}

/// Whether a text starts with a name, given in lower case, in whatever case.
bool startsWithName(std::string_view text, std::string_view name) {
    const auto same = [](char own, char other) {
        return own == (other >= 'A' && other <= 'Z' ? other - 'A' + 'a' : other);
    };
    return text.size() >= name.size() && std::equal(name.begin(), name.end(), text.begin(), same);
}

/// A decimal number; one beyond 64 bits is the largest there is, since it lies behind the end of any file.
std::optional<uint64_t> parseDigits(std::string_view text) {
    if (text.empty()) return {};
    uint64_t value = 0;
    for (const char digit : text) {
        if (digit < '0' || digit > '9') return {};
        const uint64_t next = value * 10 + static_cast<uint64_t>(digit - '0');
        const bool overflows = value > (std::numeric_limits<uint64_t>::max() - 9) / 10;
        value = overflows ? std::numeric_limits<uint64_t>::max() : next;
    }
    return value;
}

}  // namespace

bool namesTag(std::string_view field, std::string_view tag, bool weakly) {
    field = trimmed(field);
    if (field == "*") return true;
    while (!field.empty()) {
        const bool isWeak = field.starts_with("W/");
        if (isWeak) field.remove_prefix(2);
        if (!field.starts_with('"')) return false;  // no list of tags; what was read of it did not match
        const size_t end = field.find('"', 1);
        if (end == std::string_view::npos) return false;
        if (field.substr(0, end + 1) == tag && (weakly || !isWeak)) return true;
        field.remove_prefix(end + 1);
        const size_t next = field.find_first_not_of(" \t,");
        field.remove_prefix(std::min(next, field.size()));
    }
    return false;
}

std::variant<std::monostate, ByteRange, Unsatisfiable> parseRange(const std::optional<std::string>& field,
                                                                  uint64_t size) {
    constexpr std::string_view kUnit = "bytes=";
    if (!field || !startsWithName(*field, kUnit)) return {};
    const std::string_view spec = trimmed(std::string_view(*field).substr(kUnit.size()));
    const size_t dash = spec.find('-');
    if (dash == std::string_view::npos || spec.find(',') != std::string_view::npos) return {};
    const auto first = parseDigits(spec.substr(0, dash));
    const auto last = parseDigits(spec.substr(dash + 1));

    if (dash == 0) {  // "-500": the last 500 bytes
        if (!last) return {};
        if (*last == 0 || size == 0) return Unsatisfiable{};
        const uint64_t length = std::min(*last, size);
        return ByteRange{size - length, length};
    }
    const bool isOpen = dash + 1 == spec.size();
    if (!first || (!last && !isOpen) || (last && *last < *first)) return {};
    if (*first >= size) return Unsatisfiable{};
    const uint64_t end = isOpen ? size : std::min(*last, size - 1) + 1;
    return ByteRange{*first, end - *first};
}

}  // namespace terray::server
