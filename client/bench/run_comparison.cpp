#include "client/bench/run_comparison.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <limits>

#include "common/error.h"
#include "common/parse_number.h"

namespace terray {
namespace {

Json readObject(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    if (!file)
        throw Error(ExitCode::input, "cannot read " + path.string() +
                                         " (give the directory of a terray-bench replay or error that ran to its end)");
    Result<Json> json = Json::parse(text);
    if (!json) throw Error(ExitCode::input, "cannot read " + path.string() + ": " + json.failure().message);
    if (!json->isObject())
        throw Error(ExitCode::input, "cannot read " + path.string() + ": found no JSON object, which every run writes");
    return std::move(*json);
}

/// The value at a path of member names, null where there is none.
Json at(const Json& json, std::initializer_list<const char*> path) {
    const Json* found = &json;
    for (const char* name : path)
        if (found != nullptr) found = found->find(name);
    return found != nullptr ? *found : Json();
}

/// Notes as "name: a, b" where values differ, member by member of objects.
void compare(std::vector<std::string>& found, const std::string& name, const Json& a, const Json& b) {
    if (a == b) return;
    if (!a.isObject() || !b.isObject()) {
        found.push_back(name + ": " + a.dump(0) + ", " + b.dump(0));
        return;
    }
    for (const auto& [member, value] : a.object()) compare(found, name + "." + member, value, at(b, {member.c_str()}));
    for (const auto& [member, value] : b.object())
        if (a.find(member) == nullptr) compare(found, name + "." + member, Json(), value);
}

/// The columns of a run, each with its setting's name; a replay has one setting without a name.
std::vector<std::pair<std::string, Json>> settingsOf(const Json& summary) {
    const Json* settings = summary.find("settings");
    if (settings == nullptr || !settings->isArray()) return {{"", at(summary, {"columns"})}};
    std::vector<std::pair<std::string, Json>> named;
    for (const Json& setting : settings->array()) {
        const Json name = at(setting, {"name"});
        named.emplace_back(name.isString() ? name.string() : "", at(setting, {"columns"}));
    }
    return named;
}

Json namesOf(const RecordedRun& run) {
    Json names = Json::Array{};
    for (const auto& [name, columns] : settingsOf(run.summary)) names.push(name);
    return names;
}

std::optional<double> numberIn(const Json& columns, const std::string& column, const std::string& statistic) {
    const Json value = at(columns, {column.c_str(), statistic.c_str()});
    return value.isNumber() ? std::optional(value.number()) : std::nullopt;
}

std::string shortText(double value) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.6g", value);
    return text;
}

Threshold thresholdFrom(const std::string& part) {
    const auto refuse = [&]() -> Threshold {
        throw Error(ExitCode::usage, "--fail-if: found \"" + part +
                                         "\", expected a figure, > or <, and a number with an x if it is a ratio, as "
                                         "frame_ms.median>1.1x");
    };
    const size_t sign = part.find_first_of("<>");
    if (sign == std::string::npos || sign == 0) return refuse();
    Threshold threshold{.figure = part.substr(0, sign), .above = part[sign] == '>'};
    std::string number = part.substr(sign + 1);
    threshold.ratio = number.ends_with('x');
    if (threshold.ratio) number.pop_back();
    const std::optional<double> limit = parseNumber(number);
    const size_t dot = threshold.figure.find('.');
    if (!limit || dot == std::string::npos || dot == 0 || dot + 1 == threshold.figure.size()) return refuse();
    threshold.limit = *limit;
    return threshold;
}

}  // namespace

RecordedRun readRun(const std::filesystem::path& directory) {
    return {directory, readObject(directory / "manifest.json"), readObject(directory / "summary.json")};
}

std::vector<std::string> unlikenesses(const RecordedRun& a, const RecordedRun& b) {
    std::vector<std::string> found;
    const auto require = [&](const char* name, std::initializer_list<const char*> path) {
        compare(found, name, at(a.manifest, path), at(b.manifest, path));
    };
    require("program", {"program"});
    require("dataset's content", {"dataset", "contentHash"});
    require("flight's checksum", {"flight", "crc32c"});
    require("protocol", {"protocol"});
    require("sweep", {"sweep"});
    if (found.empty()) compare(found, "settings", namesOf(a), namesOf(b));
    return found;
}

std::vector<std::string> differences(const RecordedRun& a, const RecordedRun& b) {
    std::vector<std::string> found;
    for (const char* part : {"build", "machine", "graphics", "options"})
        compare(found, part, at(a.manifest, {part}), at(b.manifest, {part}));
    return found;
}

std::optional<double> Figure::ratio() const {
    if (!a || !b) return std::nullopt;
    if (*a == *b) return 1;
    if (*a == 0) return std::copysign(std::numeric_limits<double>::infinity(), *b);
    return *b / *a;
}

std::string Figure::title() const {
    return setting.empty() ? name : setting + ": " + name;
}

std::vector<Figure> figuresOf(const RecordedRun& a, const RecordedRun& b) {
    std::vector<Figure> figures;
    const auto ofA = settingsOf(a.summary);
    const auto ofB = settingsOf(b.summary);
    for (size_t n = 0; n < std::min(ofA.size(), ofB.size()); ++n) {
        const auto& [setting, columns] = ofA[n];
        // Columns of A, then those that only B has.
        for (const Json* names : {&columns, &ofB[n].second}) {
            if (!names->isObject()) continue;
            for (const auto& [column, statistics] : names->object()) {
                const bool told = names != &columns && columns.find(column) != nullptr;
                if (told || !statistics.isObject()) continue;
                for (const auto& [statistic, value] : statistics.object())
                    figures.push_back({setting, column + "." + statistic, numberIn(columns, column, statistic),
                                       numberIn(ofB[n].second, column, statistic)});
            }
        }
    }
    return figures;
}

std::vector<Threshold> thresholdsFrom(const std::string& text) {
    std::vector<Threshold> thresholds;
    for (size_t start = 0; start <= text.size();) {
        const size_t end = std::min(text.find(',', start), text.size());
        thresholds.push_back(thresholdFrom(text.substr(start, end - start)));
        start = end + 1;
    }
    return thresholds;
}

std::vector<std::string> crossings(const std::vector<Threshold>& thresholds, const std::vector<Figure>& figures) {
    std::vector<std::string> crossed;
    for (const Threshold& threshold : thresholds) {
        bool known = false;
        for (const Figure& figure : figures) {
            if (figure.name != threshold.figure) continue;
            known = true;
            const std::optional<double> value = threshold.ratio ? figure.ratio() : figure.b;
            if (!value)
                throw Error(ExitCode::usage,
                            "--fail-if: " + figure.title() + " has no value in " + (figure.a ? "RUN_B" : "RUN_A"));
            if (threshold.above ? *value <= threshold.limit : *value >= threshold.limit) continue;
            const std::string unit = threshold.ratio ? " times RUN_A's" : "";
            crossed.push_back(figure.title() + " is " + shortText(*value) + unit + ", allowed is " +
                              (threshold.above ? "at most " : "at least ") + shortText(threshold.limit));
        }
        if (!known)
            throw Error(ExitCode::usage, "--fail-if: the runs have no figure " + threshold.figure +
                                             " (compare without --fail-if and with --all lists them)");
    }
    return crossed;
}

}  // namespace terray
