#include "client/engine/dataset_options.h"

namespace terray {

void DatasetCommandLine::declare(CommandLine& line) {
    line.positional("DATASET", place_,
                    "directory made by terray-preprocess, or http(s)://HOST/NAME, or the address of a heights.pmtiles")
        .required();
    line.option("--disk-cache", diskCache_, "DIR", "keep what is fetched from a server there, for later runs");
    line.bytes("--disk-cache-size", diskCacheBytes_, "of the files in it (4G)");
}

std::unique_ptr<TileSource> DatasetCommandLine::open() const {
    return openDataset(place_, {.directory = diskCache_, .maxBytes = diskCacheBytes_});
}

}  // namespace terray
