#include "client/render/method.h"

#include <cmath>
#include <cstdio>

#include "common/error.h"
#include "common/parse_number.h"

namespace terray {
namespace {

std::string shortText(double value) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.6g", value);
    return text;
}

[[noreturn]] void refuse(const std::string& found, const std::string& expected) {
    throw Error(ExitCode::usage, "--method: found \"" + found + "\", expected " + expected);
}

Method methodOf(const std::string& name) {
    std::string expected;
    for (const MethodEntry& entry : kMethods) {
        if (entry.name == name) return entry.method;
        expected += (expected.empty() ? "one of " : ", ") + std::string(entry.name);
    }
    refuse(name, expected);
}

std::string nameOf(MethodKey::Kind kind) {
    if (kind == MethodKey::Kind::any) return "a number";
    return kind == MethodKey::Kind::whole ? "a whole number" : "a power of two";
}

bool isOf(MethodKey::Kind kind, double value) {
    if (kind == MethodKey::Kind::any) return true;
    return kind == MethodKey::Kind::whole ? value == std::floor(value)
                                          : std::exp2(std::floor(std::log2(value))) == value;
}

void setKey(MethodOptions& options, const std::string& assignment) {
    const size_t equals = assignment.find('=');
    const std::string key = assignment.substr(0, equals);
    std::string known;
    for (const MethodKey& entry : kMethodKeys) {
        if (entry.method != options.method) continue;
        known += (known.empty() ? "" : ", ") + std::string(entry.key);
        if (entry.key != key) continue;
        const auto value = equals == std::string::npos ? std::nullopt : parseNumber(assignment.substr(equals + 1));
        if (!value || *value < entry.lowest || *value > entry.highest || !isOf(entry.kind, *value))
            refuse(assignment, key + "= and " + nameOf(entry.kind) + " from " + shortText(entry.lowest) + " to " +
                                   shortText(entry.highest));
        options.*entry.value = *value;
        return;
    }
    const std::string name(entryOf(options.method).name);
    refuse(assignment, known.empty() ? "nothing after \"" + name + "\": it has no numbers to set"
                                     : "KEY=VALUE with a key of " + name + ": " + known);
}

}  // namespace

MethodOptions methodNamed(const std::string& text) {
    const size_t colon = text.find(':');
    MethodOptions options{.method = methodOf(text.substr(0, colon))};
    for (size_t at = colon; at != std::string::npos;) {
        const size_t end = text.find(',', at + 1);
        setKey(options, text.substr(at + 1, end == std::string::npos ? end : end - at - 1));
        at = end;
    }
    if (options.method == Method::linear && options.least > options.most)
        refuse(text, "least not above most, which is " + shortText(options.most));
    return options;
}

std::string description(const MethodOptions& options) {
    std::string text(entryOf(options.method).name);
    const MethodOptions defaults;
    char before = ':';
    for (const MethodKey& entry : kMethodKeys) {
        if (entry.method != options.method || options.*entry.value == defaults.*entry.value) continue;
        text += before + std::string(entry.key) + "=" + shortText(options.*entry.value);
        before = ',';
    }
    return text;
}

interop::MethodParameters methodParameters(const MethodOptions& options) {
    const double stride = options.exponential != 0 ? -1 : options.stride / options.quads;
    return {.linear = glm::vec4(glm::dvec4(options.least, options.most, options.halvings, 0)),
            .hull = glm::vec4(glm::dvec4(options.steps, options.more, stride, options.secants)),
            .hullMore = glm::vec4(glm::dvec4(options.coarser, 0, 0, 0)),
            .cones = glm::vec4(glm::dvec4(options.coneSteps, options.reach, options.coneHalvings, 0))};
}

}  // namespace terray
