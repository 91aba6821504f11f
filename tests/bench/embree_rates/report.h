#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/embree_rates/agreement.h"
#include "tests/bench/embree_rates/rates.h"
#include "tests/bench/embree_rates/rivals.h"

namespace terray {

// Markdown tables of the benchmark, printed to stdout: rows are casters or quantities, columns are views.

/// Which casters of a view's list the summary sets against each other.
enum : size_t { kEmbreeEight, kEmbreeAny, kMarch };

void printRates(const std::vector<NamedView>& views, const std::vector<std::vector<Caster>>& casters,
                const std::vector<std::vector<Series>>& series);

/// What a structure takes.
struct Footprint {
    std::string name;
    Spread buildSeconds;
    int64_t bytes;      ///< of the structure itself
    int64_t dataBytes;  ///< of the heights or vertices that it needs beside
};
void printFootprints(const std::vector<Footprint>& footprints);

void printSteps(const std::vector<NamedView>& views, const std::vector<StepCounts>& steps);

/// The march against robust Embree, and what the fastest setting of Embree leaves open.
struct ViewAgreement {
    Agreement surfaces;
    Truth marchTruth;
    Truth meshTruth;
    int64_t holes = 0;  ///< pixels without a hit in fastest Embree that the march and robust Embree hit
};
void printAgreement(const std::vector<NamedView>& views, const std::vector<ViewAgreement>& agreements);

}  // namespace terray
