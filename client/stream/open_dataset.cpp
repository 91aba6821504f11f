#include "client/stream/open_dataset.h"

#include "client/stream/web_address.h"
#include "common/error.h"
#if TERRAY_WITH_CURL
#include "client/stream/web_dataset.h"
#endif

namespace terray {

std::unique_ptr<TileSource> openDataset(const std::string& place, const DiskCacheOptions& diskCache) {
    if (!isWebAddress(place) && !diskCache.directory.empty())
        throw Error(ExitCode::usage, "--disk-cache: found a dataset on the local disk, " + place +
                                         ", expected one on a web server; leave the option out");
    if (!isWebAddress(place)) return openLocalDataset(place);
#if TERRAY_WITH_CURL
    return openWebDataset(place, {.diskCache = diskCache});
#else
    throw Error(ExitCode::unsupported, "cannot open dataset " + place +
                                           ": this build has no libcurl (TERRAY_WITH_CURL is off); give a directory");
#endif
}

}  // namespace terray
