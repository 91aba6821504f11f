#include "preprocess/ranks.h"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace terray {

bool isOneOfSeveral() {
    // What the launchers tell those that they start. Asking MPI itself would start it, in every run of the program.
    constexpr std::array kCounts = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MPI_LOCALNRANKS"};
    constexpr std::array kRanks = {"PMIX_RANK", "PMI_RANK"};
    return std::ranges::any_of(kCounts,
                               [](const char* name) {
                                   const char* const count = std::getenv(name);
                                   return count != nullptr && std::atoi(count) > 1;
                               }) ||
           std::ranges::any_of(kRanks, [](const char* name) { return std::getenv(name) != nullptr; });
}

}  // namespace terray
