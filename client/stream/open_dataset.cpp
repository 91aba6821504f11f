#include "client/stream/open_dataset.h"

#include "client/stream/web_address.h"
#include "common/error.h"
#if TERRAY_WITH_CURL
#include "client/stream/web_dataset.h"
#endif

namespace terray {

std::unique_ptr<TileSource> openDataset(const std::string& place) {
    if (!isWebAddress(place)) return openLocalDataset(place);
#if TERRAY_WITH_CURL
    return openWebDataset(place, {});
#else
    throw Error(ExitCode::unsupported, "cannot open dataset " + place +
                                           ": this build has no libcurl (TERRAY_WITH_CURL is off); give a directory");
#endif
}

}  // namespace terray
