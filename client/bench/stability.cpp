#include "client/bench/stability.h"

#include <cstdio>
#include <span>

#include "client/bench/bench.h"
#include "client/bench/manifest.h"
#include "client/bench/run_directory.h"
#include "client/bench/stability_report.h"
#include "client/render/gl_context.h"
#include "common/command_line.h"
#include "common/output_file.h"

namespace terray {
namespace {

struct StabilityOptions {
    std::string out;
    std::string method = "pyramid";
    std::string named;
    bool list = false;
    bool force = false;
};

bool parse(StabilityOptions& options, const std::vector<std::string>& arguments) {
    CommandLine line("terray-bench stability",
                     "Casts rays at grounds and from places that are hard on arithmetic, and holds each hit against a "
                     "bound. Exit code 8 when one is crossed.");
    line.option("--out", options.out, "DIR", "for stability.csv, summary.json and manifest.json");
    line.option("--method", options.method, "NAME[:KEY=VALUE,...]", "how surfaces are found (pyramid)");
    line.option("--case", options.named, "NAME", "only cases in whose name this occurs");
    line.flag("--list", options.list, "only print the cases' names");
    line.flag("--force", options.force, "replace an earlier run in DIR");
    return line.parse(arguments);
}

std::vector<StabilityCase> chosenCases(const std::string& named) {
    std::vector<StabilityCase> cases = stabilityCases();
    std::erase_if(cases, [&](const StabilityCase& of) { return of.name.find(named) == std::string::npos; });
    if (cases.empty())
        throw Error(ExitCode::usage, "--case: found \"" + named + "\", expected a part of a case's name (--list)");
    return cases;
}

Json summaryOf(const std::vector<StabilityRow>& rows) {
    Json list = Json::Array{};
    for (const StabilityRow& row : rows) list.push(toJson(row));
    return Json::Object{{"rows", std::move(list)}};
}

void write(const StabilityOptions& options, const std::vector<StabilityRow>& rows, const GlStrings& graphics,
           const std::string& started) {
    RunDirectory directory(options.out, false, options.force);
    const std::string table = stabilityTable(rows);
    writeWholeFile(directory.stability(), std::as_bytes(std::span(table)));
    writeJson(directory.summary(), summaryOf(rows));
    writeJson(directory.manifest(),
              Json::Object{{"program", "terray-bench stability"},
                           {"build", describeBuild()},
                           {"machine", describeMachine()},
                           {"graphics", describeGraphics(graphics)},
                           {"options", Json::Object{{"method", options.method}, {"case", options.named}}},
                           {"started", started}});
    directory.keep();
    std::printf("written: %s, %s, %s\n", directory.stability().c_str(), directory.summary().c_str(),
                directory.manifest().c_str());
}

}  // namespace

ExitCode runStability(const std::vector<std::string>& arguments) {
    StabilityOptions options;
    if (!parse(options, arguments)) return ExitCode::ok;
    const MethodOptions method = methodNamed(options.method);
    const std::vector<StabilityCase> cases = chosenCases(options.named);
    if (options.list) {
        for (const StabilityCase& of : cases) std::printf("%s\n", of.name.c_str());
        return ExitCode::ok;
    }
    const std::string started = utcNow();
    const HeadlessContext context;
    requireRendererFeatures();
    const ShaderLibrary shaders;
    std::vector<StabilityRow> rows;
    size_t failed = 0;
    std::printf("%s\n", stabilityHeading().c_str());
    for (const StabilityCase& of : cases)
        for (const StabilityRow& row : runStabilityCase(of, shaders, method)) {
            std::printf("%s\n", lineOf(row).c_str());
            std::fflush(stdout);
            failed += row.met() ? 0 : 1;
            rows.push_back(row);
        }
    std::printf("%zu rows, %zu failed\n", rows.size(), failed);
    if (!options.out.empty()) write(options, rows, context.strings(), started);
    return failed > 0 ? ExitCode::verification : ExitCode::ok;
}

}  // namespace terray
