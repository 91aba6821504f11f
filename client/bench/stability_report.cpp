#include "client/bench/stability_report.h"

#include <cstdio>

namespace terray {
namespace {

const char* surfaceOf(const StabilityRow& row) {
    return row.columns ? "columns" : "bilinear";
}

const char* verdictOf(const StabilityRow& row) {
    return row.met() ? "met" : "FAILED";
}

}  // namespace

std::string stabilityHeading() {
    char line[256];
    std::snprintf(line, sizeof(line), "%-50s %-11s %-8s %8s %7s %11s %7s %10s %10s %6s %8s  %s", "case", "caster",
                  "surface", "rays", "wrong", "see-through", "NaN", "texels", "pixels", "steps", "no steps", "verdict");
    return line;
}

std::string lineOf(const StabilityRow& row) {
    char line[256];
    std::snprintf(line, sizeof(line), "%-50s %-11s %-8s %8llu %7llu %11llu %7llu %10.3g %10.3g %6u %8llu  %s",
                  row.name.c_str(), name(row.caster), surfaceOf(row), static_cast<unsigned long long>(row.rays),
                  static_cast<unsigned long long>(row.wrong), static_cast<unsigned long long>(row.seeThrough),
                  static_cast<unsigned long long>(row.notANumber), row.worstTexels, row.worstPixels, row.worstSteps,
                  static_cast<unsigned long long>(row.outOfSteps), verdictOf(row));
    return line;
}

std::string stabilityTable(const std::vector<StabilityRow>& rows) {
    std::string table =
        "case,caster,surface,rays,wrong,see_through,covers_sky,misplaced,unmirrored,nan,error_texels_max,error_px_max,"
        "steps_max,out_of_steps,verdict\n";
    for (const StabilityRow& row : rows) {
        char line[512];
        std::snprintf(line, sizeof(line), "\"%s\",%s,%s,%llu,%llu,%llu,%llu,%llu,%llu,%llu,%.6g,%.6g,%u,%llu,%s\n",
                      row.name.c_str(), name(row.caster), surfaceOf(row), static_cast<unsigned long long>(row.rays),
                      static_cast<unsigned long long>(row.wrong), static_cast<unsigned long long>(row.seeThrough),
                      static_cast<unsigned long long>(row.coversSky), static_cast<unsigned long long>(row.misplaced),
                      static_cast<unsigned long long>(row.unmirrored), static_cast<unsigned long long>(row.notANumber),
                      row.worstTexels, row.worstPixels, row.worstSteps, static_cast<unsigned long long>(row.outOfSteps),
                      verdictOf(row));
        table += line;
    }
    return table;
}

Json toJson(const StabilityRow& row) {
    return Json::Object{{"case", row.name},
                        {"caster", name(row.caster)},
                        {"surface", surfaceOf(row)},
                        {"rays", row.rays},
                        {"wrong", row.wrong},
                        {"seeThrough", row.seeThrough},
                        {"coversSky", row.coversSky},
                        {"misplaced", row.misplaced},
                        {"unmirrored", row.unmirrored},
                        {"nan", row.notANumber},
                        {"errorTexelsMax", row.worstTexels},
                        {"errorPixelsMax", row.worstPixels},
                        {"stepsMax", row.worstSteps},
                        {"outOfSteps", row.outOfSteps},
                        {"met", row.met()}};
}

}  // namespace terray
