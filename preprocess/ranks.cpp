#include "preprocess/ranks.h"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace terray {

bool isOneOfSeveral() {
    // What the launchers tell those that they start: Open MPI's mpirun, MPICH's, srun. Asking MPI itself would start
    // it, in every run of the program.
    constexpr std::array kCounts = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MPI_LOCALNRANKS", "SLURM_STEP_NUM_TASKS"};
    return std::ranges::any_of(kCounts, [](const char* name) {
        const char* const count = std::getenv(name);
        return count != nullptr && std::atoi(count) > 1;
    });
}

}  // namespace terray
