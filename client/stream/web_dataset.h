#pragma once

#include <memory>
#include <string>

#include "client/stream/dataset_source.h"
#include "client/stream/disk_cache.h"
#include "client/stream/http_client.h"

namespace terray {

struct WebOptions {
    HttpOptions http;
    /// Of each request while the dataset is opened: who has mistyped an address should not wait for long.
    int attemptsToOpen = 3;
    DiskCacheOptions diskCache;
};

/// Opens a dataset on a web server by range requests (archiveAddress). Opening reads both archives' directories,
/// metadata and root tiles; these stay in memory. read() blocks; startReads() runs options.http.connections transfers
/// at a time. Archives that are replaced on the server while they are open (another ETag or size) count as damaged.
///
/// What options.diskCache holds is not fetched, but for the first bytes of each archive, which tell its version.
///
/// Throws Error(network) when the server cannot be reached, or fails for now; Error(dataset) when there is no dataset,
/// it is damaged, has another format version, or the server knows no range requests; Error(usage) for a bad address,
/// Error(output) for a disk cache that cannot be written into.
[[nodiscard]] std::unique_ptr<TileSource> openWebDataset(const std::string& address, const WebOptions& options);

}  // namespace terray
