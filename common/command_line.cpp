#include "common/command_line.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string_view>

#include "common/check.h"
#include "common/error.h"

namespace terray {
namespace {

[[noreturn]] void refuse(const std::string& message) {
    throw Error(ExitCode::usage, message);
}

/// Reads a whole text as a number; nothing when anything is left over, or the number is not finite.
template <class Number>
std::optional<Number> parseNumber(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    Number number{};
    const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
    if (result.ec != std::errc() || result.ptr != text.data() + text.size()) return {};
    if constexpr (std::is_floating_point_v<Number>)
        if (!std::isfinite(number)) return {};
    return number;
}

/// A number with an optional suffix K, M, G or T, in bytes.
std::optional<uint64_t> parseBytes(std::string_view text) {
    constexpr std::string_view kSuffixes = "KMGT";
    constexpr double kLimit = 9.0e18;  // below 2^63
    double factor = 1;
    const size_t power = text.empty() ? std::string_view::npos : kSuffixes.find(text.back());
    if (power != std::string_view::npos) {
        factor = std::ldexp(1.0, 10 * static_cast<int>(power + 1));
        text.remove_suffix(1);
    }
    const auto number = parseNumber<double>(text);
    if (!number || *number < 0 || *number * factor > kLimit) return {};
    return static_cast<uint64_t>(*number * factor);
}

/// Whether an argument can only be an option: a dash that starts no number ("-3", "-.5") and is not alone.
bool looksLikeOption(const std::string& argument) {
    if (argument.size() < 2 || argument[0] != '-') return false;
    const char next = argument[1];
    return !(next >= '0' && next <= '9') && next != '.';
}

/// Insertions, removals and replacements of letters that turn one name into another (Levenshtein 1966).
size_t editDistance(std::string_view from, std::string_view to) {
    std::vector<size_t> row(to.size() + 1);
    std::iota(row.begin(), row.end(), size_t{0});
    for (size_t i = 0; i < from.size(); ++i) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < to.size(); ++j) {
            const size_t replaced = diagonal + (from[i] == to[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row.back();
}

}  // namespace

CommandLine::CommandLine(std::string program, std::string summary)
    : program_(std::move(program)), summary_(std::move(summary)) {}

CommandLine::Option& CommandLine::Option::required() {
    line_.options_[index_].isRequired = true;
    return *this;
}

CommandLine::Option& CommandLine::Option::given(bool& flag) {
    line_.options_[index_].given = &flag;
    return *this;
}

CommandLine::Option CommandLine::declare(Declared declared) {
    for (const Declared& other : options_) TERRAY_CHECK(other.name != declared.name);
    options_.push_back(std::move(declared));
    return {*this, options_.size() - 1};
}

CommandLine::Option CommandLine::flag(std::string name, bool& target, std::string help) {
    return declare(
        {.name = std::move(name), .help = std::move(help), .assign = [&target](const std::string&) { target = true; }});
}

CommandLine::Option CommandLine::option(std::string name, std::string& target, std::string valueName,
                                        std::string help) {
    return declare({.name = std::move(name),
                    .valueName = std::move(valueName),
                    .help = std::move(help),
                    .assign = [&target](const std::string& text) { target = text; }});
}

CommandLine::Option CommandLine::option(std::string name, double& target, std::string valueName, std::string help) {
    const auto assign = [&target](const std::string& text) {
        const auto number = parseNumber<double>(text);
        if (!number) refuse("is not a number");
        target = *number;
    };
    return declare(
        {.name = std::move(name), .valueName = std::move(valueName), .help = std::move(help), .assign = assign});
}

CommandLine::Option CommandLine::option(std::string name, int64_t& target, std::string valueName, std::string help) {
    const auto assign = [&target](const std::string& text) {
        const auto number = parseNumber<int64_t>(text);
        if (!number) refuse("is not a whole number");
        target = *number;
    };
    return declare(
        {.name = std::move(name), .valueName = std::move(valueName), .help = std::move(help), .assign = assign});
}

CommandLine::Option CommandLine::option(std::string name, std::optional<double>& target, std::string valueName,
                                        std::string help) {
    const auto assign = [&target](const std::string& text) {
        const auto number = parseNumber<double>(text);
        if (!number) refuse("is not a number");
        target = *number;
    };
    return declare(
        {.name = std::move(name), .valueName = std::move(valueName), .help = std::move(help), .assign = assign});
}

CommandLine::Option CommandLine::list(std::string name, std::vector<std::string>& target, std::string valueName,
                                      std::string help) {
    return declare({.name = std::move(name),
                    .valueName = std::move(valueName),
                    .help = std::move(help),
                    .takesMany = true,
                    .assign = [&target](const std::string& text) { target.push_back(text); }});
}

CommandLine::Option CommandLine::bytes(std::string name, uint64_t& target, std::string help) {
    const auto assign = [&target](const std::string& text) {
        const auto number = parseBytes(text);
        if (!number) refuse("is not a number of bytes such as 4096, 512M or 2G");
        target = *number;
    };
    return declare({.name = std::move(name), .valueName = "BYTES", .help = std::move(help), .assign = assign});
}

CommandLine::Option CommandLine::size(std::string name, int& width, int& height, std::string help) {
    const auto assign = [&width, &height](const std::string& text) {
        constexpr int kLargest = 65536;
        const std::string_view view(text);
        const size_t cross = view.find('x');
        const auto w = parseNumber<int>(view.substr(0, cross));
        const auto h = parseNumber<int>(cross == std::string_view::npos ? "" : view.substr(cross + 1));
        const auto fits = [](const std::optional<int>& n) { return n && *n >= 1 && *n <= kLargest; };
        if (!fits(w) || !fits(h)) refuse("is not a size such as 1280x720, each side 1 to 65536");
        width = *w;
        height = *h;
    };
    return declare({.name = std::move(name), .valueName = "WxH", .help = std::move(help), .assign = assign});
}

CommandLine::Option CommandLine::positional(std::string name, std::string& target, std::string help) {
    return declare({.name = std::move(name),
                    .help = std::move(help),
                    .isPositional = true,
                    .assign = [&target](const std::string& text) { target = text; }});
}

CommandLine::Option CommandLine::positionals(std::string name, std::vector<std::string>& target, std::string help) {
    return declare({.name = std::move(name),
                    .help = std::move(help),
                    .isPositional = true,
                    .takesMany = true,
                    .assign = [&target](const std::string& text) { target.push_back(text); }});
}

void CommandLine::refuseUnknown(const std::string& name) const {
    const Declared* nearest = nullptr;
    size_t nearestDistance = std::max<size_t>(name.size() / 2, 2);  // further away it is no slip of the fingers
    for (const Declared& option : options_) {
        const size_t distance = editDistance(name, option.name);
        if (option.isPositional || distance > nearestDistance) continue;
        if (nearest == nullptr || distance < nearestDistance) nearest = &option;
        nearestDistance = distance;
    }
    refuse("unknown option " + name +
           (nearest != nullptr ? ", did you mean " + nearest->name + "?" : " (--help lists the options)"));
}

void CommandLine::give(Declared& option, const std::string& value) {
    if (option.seen && !option.takesMany) refuse(option.name + " is given twice");
    option.seen = true;
    if (option.given != nullptr) *option.given = true;
    try {
        option.assign(value);
    } catch (const Error& error) {
        refuse(option.name + ": \"" + value + "\" " + error.what());
    }
}

void CommandLine::givePositional(const std::string& value) {
    for (Declared& option : options_) {
        if (!option.isPositional || (option.seen && !option.takesMany)) continue;
        give(option, value);
        return;
    }
    refuse("unexpected argument \"" + value + "\"");
}

size_t CommandLine::giveOption(const std::vector<std::string>& arguments, size_t index) {
    const std::string& argument = arguments[index];
    const size_t equals = argument.find('=');
    const std::string name = argument.substr(0, equals);
    const auto found = std::find_if(options_.begin(), options_.end(),
                                    [&](const Declared& o) { return !o.isPositional && o.name == name; });
    if (found == options_.end()) refuseUnknown(name);

    const bool isFlag = found->valueName.empty();
    if (equals != std::string::npos) {
        if (isFlag) refuse(name + " takes no value");
        give(*found, argument.substr(equals + 1));
        return index + 1;
    }
    if (isFlag) {
        give(*found, "");
        return index + 1;
    }
    const size_t first = index + 1;
    size_t next = first;
    while (next < arguments.size() && !looksLikeOption(arguments[next]) && (next == first || found->takesMany))
        give(*found, arguments[next++]);
    if (next == first) refuse(name + " needs a value: " + name + " " + found->valueName);
    return next;
}

bool CommandLine::parse(const std::vector<std::string>& arguments) {
    // Only what stands before "--" is an option; a request for help outranks any mistake beside it.
    const auto separator = std::find(arguments.begin(), arguments.end(), "--");
    if (std::any_of(arguments.begin(), separator, [](const auto& a) { return a == "--help" || a == "-h"; })) {
        std::fputs(help().c_str(), stdout);
        return false;
    }
    const auto optionsEnd = static_cast<size_t>(separator - arguments.begin());
    for (size_t index = 0; index < arguments.size();) {
        if (index == optionsEnd) {
            ++index;
        } else if (index < optionsEnd && looksLikeOption(arguments[index])) {
            index = giveOption(arguments, index);
        } else {
            givePositional(arguments[index++]);
        }
    }
    for (const Declared& option : options_) {
        if (!option.isRequired || option.seen) continue;
        const std::string value = option.valueName.empty() ? "" : " " + option.valueName;
        refuse(option.name + value + " is missing (" + option.help + ")");
    }
    return true;
}

std::string CommandLine::help() const {
    constexpr size_t kHelpColumn = 34;
    const auto synopsis = [](const Declared& option) {
        const std::string value = option.valueName.empty() ? "" : " " + option.valueName;
        return option.name + value + (option.takesMany ? "..." : "");
    };
    std::string usage = "Usage: " + program_;
    std::string lines;
    // Positional arguments come first in both, whatever the order of declaration.
    for (const bool positional : {true, false})
        for (const Declared& option : options_) {
            if (option.isPositional != positional) continue;
            const std::string text = synopsis(option);
            usage += option.isRequired ? " " + text : " [" + text + "]";
            std::string line = "  " + text;
            line += line.size() < kHelpColumn ? std::string(kHelpColumn - line.size(), ' ')
                                              : "\n" + std::string(kHelpColumn, ' ');
            lines += line + option.help + (option.isRequired ? " (required)" : "") + "\n";
        }
    return usage + "\n\n" + summary_ + "\n\n" + lines + "  --help" + std::string(kHelpColumn - 8, ' ') +
           "show this text\n";
}

}  // namespace terray
