#include "client/view/arguments.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace terray {
namespace {

bool names(std::string_view argument, std::string_view option) {
    if (!argument.starts_with("--")) return false;
    return argument.substr(2, argument.find('=') - 2) == option;
}

}  // namespace

bool gives(const Arguments& arguments, std::string_view name) {
    return std::any_of(arguments.begin(), arguments.end(), [&](const std::string& word) { return names(word, name); });
}

Arguments withoutOptions(const Arguments& arguments, std::span<const std::string_view> options) {
    Arguments rest;
    for (size_t n = 0; n < arguments.size(); ++n) {
        const std::string& word = arguments[n];
        const bool dropped =
            std::any_of(options.begin(), options.end(), [&](std::string_view option) { return names(word, option); });
        if (!dropped) rest.push_back(word);
        if (dropped && word.find('=') == std::string::npos) ++n;  // its value follows
    }
    return rest;
}

Arguments withOptions(Arguments arguments, const OptionTexts& options) {
    for (const auto& [name, value] : options) arguments.push_back("--" + name + "=" + value);
    return arguments;
}

std::string numberText(double number) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
    return {text.data(), end};
}

}  // namespace terray
