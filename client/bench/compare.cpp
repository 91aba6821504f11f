#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "client/bench/bench.h"
#include "client/bench/run_comparison.h"
#include "common/command_line.h"

namespace terray {
namespace {

struct CompareOptions {
    std::string a;
    std::string b;
    std::string failIf;
    std::vector<Threshold> thresholds;
    bool all = false;
    bool json = false;
};

bool parse(CompareOptions& options, const std::vector<std::string>& arguments) {
    bool given = false;
    CommandLine line("terray-bench compare",
                     "Holds the figures of a run against those of another that was measured alike.");
    line.positional("RUN_A", options.a, "directory of terray-bench replay or error: the measure").required();
    line.positional("RUN_B", options.b, "likewise: what is judged").required();
    line.option("--fail-if", options.failIf, "LIMITS",
                "exit with 11 if B crosses one, as \"frame_ms.median>1.1x,see_through.sum>0\": x is times A's figure")
        .given(given);
    line.flag("--all", options.all, "print every figure, the equal ones too");
    line.flag("--json", options.json, "print JSON");
    if (!line.parse(arguments)) return false;
    if (given) options.thresholds = thresholdsFrom(options.failIf);
    return true;
}

void refuseUnlike(const RecordedRun& a, const RecordedRun& b) {
    std::string found;
    for (const std::string& unlike : unlikenesses(a, b)) found += "\n  " + unlike;
    if (!found.empty())
        throw Error(ExitCode::usage, "cannot compare " + a.directory.string() + " with " + b.directory.string() +
                                         ", they were not measured alike; found (A, B)" + found);
}

/// What a reader looks for first: the middle and the end of a distribution, and what has no distribution.
bool isMain(const Figure& figure) {
    constexpr std::array<std::string_view, 4> kMain{"median", "p99", "sum", "last"};
    const std::string_view name = figure.name;
    const std::string_view statistic = name.substr(name.rfind('.') + 1);
    for (const std::string_view main : kMain)
        if (statistic == main) return true;
    return name == "psnr_db.mean";
}

std::string numberText(const std::optional<double>& value) {
    if (!value) return "-";
    char text[32];
    std::snprintf(text, sizeof(text), "%.6g", *value);
    return text;
}

std::string ratioText(const Figure& figure) {
    const std::optional<double> ratio = figure.ratio();
    if (!ratio) return "-";
    char text[32];
    std::snprintf(text, sizeof(text), "%.3fx", *ratio);
    return text;
}

void print(const std::vector<Figure>& figures, bool all) {
    size_t equal = 0;
    size_t further = 0;
    std::string setting;
    std::printf("%-28s %14s %14s %10s\n", "", "A", "B", "B / A");
    for (const Figure& figure : figures) {
        if (!all && figure.a == figure.b) {
            ++equal;
            continue;
        }
        if (!all && !isMain(figure)) {
            ++further;
            continue;
        }
        if (figure.setting != setting) std::printf("%s\n", figure.setting.c_str());
        setting = figure.setting;
        std::printf("%-28s %14s %14s %10s\n", figure.name.c_str(), numberText(figure.a).c_str(),
                    numberText(figure.b).c_str(), ratioText(figure).c_str());
    }
    if (!all) std::printf("%zu figures are equal, %zu are left out (--all prints them)\n", equal, further);
}

Json numberJson(const std::optional<double>& value) {
    return value ? Json(*value) : Json();
}

Json listJson(const std::vector<std::string>& texts) {
    Json list = Json::Array{};
    for (const std::string& text : texts) list.push(text);
    return list;
}

void printJson(const std::vector<Figure>& figures, const std::vector<std::string>& differing,
               const std::vector<std::string>& crossed) {
    Json list = Json::Array{};
    for (const Figure& figure : figures)
        list.push(Json::Object{{"setting", figure.setting},
                               {"name", figure.name},
                               {"a", numberJson(figure.a)},
                               {"b", numberJson(figure.b)},
                               {"ratio", numberJson(figure.ratio())}});
    const Json json =
        Json::Object{{"differing", listJson(differing)}, {"figures", std::move(list)}, {"crossed", listJson(crossed)}};
    std::printf("%s\n", json.dump().c_str());
}

}  // namespace

ExitCode runCompare(const std::vector<std::string>& arguments) {
    CompareOptions options;
    if (!parse(options, arguments)) return ExitCode::ok;
    const RecordedRun a = readRun(options.a);
    const RecordedRun b = readRun(options.b);
    refuseUnlike(a, b);
    const std::vector<std::string> differing = differences(a, b);
    const std::vector<Figure> figures = figuresOf(a, b);
    const std::vector<std::string> crossed = crossings(options.thresholds, figures);
    if (options.json) {
        printJson(figures, differing, crossed);
    } else {
        for (const std::string& difference : differing) std::printf("differs: %s\n", difference.c_str());
        print(figures, options.all);
        for (const std::string& crossing : crossed) std::printf("crossed: %s\n", crossing.c_str());
    }
    return crossed.empty() ? ExitCode::ok : ExitCode::threshold;
}

}  // namespace terray
