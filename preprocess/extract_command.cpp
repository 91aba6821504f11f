#include <memory>
#include <optional>
#include <string>

#include "preprocess/build_options.h"
#include "preprocess/dataset_archives.h"
#include "preprocess/dataset_source.h"

namespace terray {

ExitCode runExtract(const std::vector<std::string>& arguments, const std::atomic<bool>& stop, Ranks* ranks) {
    std::string directory;
    std::string bbox;
    int64_t levels = 0;
    bool hasLevels = false;
    SharedOptions shared(ranks);
    CommandLine line("terray-preprocess extract", "Builds a smaller dataset of a part of another.");
    line.positional("DIR", directory, "the dataset to take from").required();
    line.option("--bbox", bbox, "W,S,E,N", "only this area, metres in the dataset's coordinate system");
    line.option("--levels", levels, "L", "only levels 0 (the coarsest) to L, of heights and photo").given(hasLevels);
    shared.declare(line);
    if (!line.parse(arguments)) return ExitCode::ok;
    if (hasLevels && (levels < 0 || levels > kMaxTileLevel))
        throw Error(ExitCode::usage, "--levels is " + std::to_string(levels) + "; it must be from 0 to " +
                                         std::to_string(kMaxTileLevel));
    shared.check();

    const std::unique_ptr<BuildObserver> observer = makeObserver(shared.style());
    DatasetPart part{.note = [&](const std::string& text) { observer->note(text); }};
    OptionsText text("extract");
    if (!bbox.empty()) {
        part.bounds = parseBounds(bbox);
        text.add("--bbox", bbox);
    }
    if (hasLevels) {
        part.finestLevel = static_cast<uint32_t>(levels);
        text.add("--levels", std::to_string(levels));
    }
    shared.describe(text);
    const auto dataset = std::make_shared<const DatasetArchives>(openDataset(directory));
    text.add("of: " + dataset->metadata.options);
    const DatasetSources sources = openDatasetPart(dataset, part);
    BuildRequest request = shared.request(text.text(), stop, *observer);
    request.nodataPolicy = dataset->metadata.nodataPolicy;
    if (!request.maxHeightError) request.quantum = dataset->metadata.quantum;
    buildOrEstimate(*sources.heights, sources.openPhoto, request, shared);
    return ExitCode::ok;
}

}  // namespace terray
