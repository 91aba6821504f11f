#include <cstdio>
#include <string>

#include "common/command_line.h"
#include "preprocess/commands.h"
#include "preprocess/dataset_archives.h"
#include "preprocess/dataset_info.h"
#include "preprocess/verify_dataset.h"

namespace terray {

ExitCode runInfo(const std::vector<std::string>& arguments) {
    std::string directory;
    bool asJson = false;
    CommandLine line("terray-preprocess info", "Says what a dataset holds, from its headers and metadata.");
    line.positional("DIR", directory, "the dataset").required();
    line.flag("--json", asJson, "as one JSON object");
    if (!line.parse(arguments)) return ExitCode::ok;

    const DatasetInfo info = inspectDataset(openDataset(directory));
    std::fputs(asJson ? (toJson(info).dump() + "\n").c_str() : toText(info).c_str(), stdout);
    return ExitCode::ok;
}

ExitCode runVerify(const std::vector<std::string>& arguments, const std::atomic<bool>& stop) {
    std::string directory;
    CommandLine line("terray-preprocess verify",
                     "Checks every tile of a dataset: checksum, bounds, error, and what it says of its children. Exits "
                     "with 0 only if all holds, with 8 if something does not.");
    line.positional("DIR", directory, "the dataset").required();
    if (!line.parse(arguments)) return ExitCode::ok;

    const VerifyReport report = verifyDataset(openDataset(directory), machineJobs(), stop);
    for (const Fault& fault : report.faults) std::fprintf(stderr, "%s: %s\n", fault.where.c_str(), fault.what.c_str());
    std::printf("%s: %llu height tiles, %llu imagery tiles, %zu faults\n", directory.c_str(),
                static_cast<unsigned long long>(report.heightTiles),
                static_cast<unsigned long long>(report.imageryTiles), report.faults.size());
    return report.faults.empty() ? ExitCode::ok : ExitCode::verification;
}

}  // namespace terray
