#include "tests/bench/embree_rates/report.h"

#include <cmath>
#include <cstdio>
#include <functional>

namespace terray {
namespace {

std::string text(const char* format, double a, double b = 0, double c = 0) {
    char buffer[96];
    std::snprintf(buffer, sizeof buffer, format, a, b, c);
    return buffer;
}

void printHeader(const std::string& first, const std::vector<NamedView>& views, const std::string& last = "") {
    std::printf("\n| %s |", first.c_str());
    for (const NamedView& view : views) std::printf(" %s |", view.name.c_str());
    std::printf("%s\n|---|", last.empty() ? "" : (" " + last + " |").c_str());
    for (size_t i = 0; i < views.size() + (last.empty() ? 0 : 1); ++i) std::printf("---|");
    std::printf("\n");
}

/// A row with one cell for each view.
void printRow(const std::string& name, size_t views, const std::function<std::string(size_t view)>& cell) {
    std::printf("| %s |", name.c_str());
    for (size_t v = 0; v < views; ++v) std::printf(" %s |", cell(v).c_str());
    std::printf("\n");
}

/// A row of numbers with their geometric mean in the last column.
void printMeanRow(const std::string& name, size_t views, const char* format,
                  const std::function<double(size_t view)>& value) {
    double logarithms = 0;
    std::printf("| %s |", name.c_str());
    for (size_t v = 0; v < views; ++v) {
        logarithms += std::log(value(v));
        std::printf(" %s |", text(format, value(v)).c_str());
    }
    std::printf(" %s |\n", text(format, std::exp(logarithms / static_cast<double>(views))).c_str());
}

std::string errors(const Errors& errors) {
    return text("%.2g / %.2g / %.2g", errors.median, errors.percentile99, errors.most);
}

/// One row for each caster: its rate in every view, and their geometric mean.
void printRateTable(const std::string& title, const std::vector<NamedView>& views,
                    const std::vector<std::vector<Caster>>& casters, const std::vector<std::vector<Series>>& series,
                    Spread (Series::*rate)() const) {
    printHeader(title, views, "geometric mean");
    for (size_t c = 0; c < series[0].size(); ++c) {
        const std::string name = c == kEmbreeEight ? "Embree, 8 rays a call"
                                 : c == kEmbreeAny ? "Embree, 1, 8 or 16 rays a call"
                                                   : casters[0][c].name;
        double logarithms = 0;
        std::printf("| %s |", name.c_str());
        for (size_t v = 0; v < views.size(); ++v) {
            const Spread spread = (series[v][c].*rate)();
            logarithms += std::log(spread.median);
            std::printf(" %s |", text("**%.1f** (%.1f .. %.1f)", spread.median, spread.least, spread.most).c_str());
        }
        std::printf(" %.1f |\n", std::exp(logarithms / static_cast<double>(views.size())));
    }
}

}  // namespace

void printRates(const std::vector<NamedView>& views, const std::vector<std::vector<Caster>>& casters,
                const std::vector<std::vector<Series>>& series) {
    std::printf("\nMedian of %zu runs (least .. most)\n", series[0][0].frames.size());
    printRateTable("Mray/s by the clock", views, casters, series, &Series::wallRate);
    printRateTable("Mray/s by CPU time", views, casters, series, &Series::cpuRate);
    printHeader("packet march / Embree", views, "geometric mean");
    for (const size_t rival : {kEmbreeEight, kEmbreeAny}) {
        const std::string name = rival == kEmbreeEight ? "8 rays a call" : "any";
        printMeanRow(name + ", by the clock", views.size(), "%.1f",
                     [&](size_t v) { return ratio(series[v][kMarch], series[v][rival]).wall; });
        printMeanRow(name + ", by CPU time", views.size(), "%.1f",
                     [&](size_t v) { return ratio(series[v][kMarch], series[v][rival]).cpu; });
    }
    printHeader("fastest of Embree", views);
    for (const size_t rival : {kEmbreeEight, kEmbreeAny})
        printRow(rival == kEmbreeEight ? "8 rays a call" : "any", views.size(),
                 [&](size_t v) { return casters[v][rival].name; });
}

void printFootprints(const std::vector<Footprint>& footprints) {
    std::printf("\n| structure | build, s | structure, MB | heights or vertices, MB |\n|---|---|---|---|\n");
    for (const Footprint& footprint : footprints)
        std::printf("| %s | %s | %.1f | %.1f |\n", footprint.name.c_str(),
                    text("%.3f (%.3f .. %.3f)", footprint.buildSeconds.median, footprint.buildSeconds.least,
                         footprint.buildSeconds.most)
                        .c_str(),
                    1e-6 * static_cast<double>(footprint.bytes), 1e-6 * static_cast<double>(footprint.dataBytes));
}

void printSteps(const std::vector<NamedView>& views, const std::vector<StepCounts>& steps) {
    printHeader("steps", views);
    printRow("scalar march, a ray", views.size(), [&](size_t v) { return text("%.1f", steps[v].scalar); });
    printRow("packet march, a packet: beams, blocks, patches", views.size(),
             [&](size_t v) { return text("%.2f, %.1f, %.1f", steps[v].beams, steps[v].pyramid, steps[v].patches); });
}

void printAgreement(const std::vector<NamedView>& views, const std::vector<ViewAgreement>& agreements) {
    printHeader("agreement with robust Embree", views);
    const auto row = [&](const char* name, const std::function<std::string(const ViewAgreement&)>& cell) {
        printRow(name, views.size(), [&](size_t v) { return cell(agreements[v]); });
    };
    const auto count = [](int64_t n) { return std::to_string(n); };
    row("pixels that hit in both, %", [&](const ViewAgreement& a) {
        return text("%.1f", 100.0 * static_cast<double>(a.surfaces.bothHit) / static_cast<double>(a.surfaces.pixels));
    });
    row("only march hits, only Embree hits", [&](const ViewAgreement& a) {
        return count(a.surfaces.onlyMarchHits) + ", " + count(a.surfaces.onlyMeshHits);
    });
    row("holes of the fastest Embree", [&](const ViewAgreement& a) { return count(a.holes); });
    row("depth, march - Embree, m: median / 99 % / most",
        [](const ViewAgreement& a) { return errors(a.surfaces.depth); });
    row("march's hits off the bilinear surface, m",
        [](const ViewAgreement& a) { return errors(a.surfaces.marchResidual); });
    row("Embree's hits off the bilinear surface, m",
        [](const ViewAgreement& a) { return errors(a.surfaces.meshResidual); });
    row("of them by more than a quarter of the twist + 1 cm",
        [&](const ViewAgreement& a) { return count(a.surfaces.unexplained); });
    row("brute force: rays", [&](const ViewAgreement& a) { return count(a.marchTruth.rays); });
    row("hit or miss against it: march, Embree", [&](const ViewAgreement& a) {
        return count(a.marchTruth.disagreements) + ", " + count(a.meshTruth.disagreements);
    });
    row("depth, march - brute force, m", [](const ViewAgreement& a) { return errors(a.marchTruth.depth); });
    row("depth, Embree - brute force, m", [](const ViewAgreement& a) { return errors(a.meshTruth.depth); });
}

}  // namespace terray
