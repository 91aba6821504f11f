#pragma once

#include <memory>
#include <string>

#include "client/stream/dataset_source.h"
#include "client/stream/disk_cache.h"

namespace terray {

/// Opens a dataset by its directory, or by its address on a web server: http(s)://HOST/NAME of a terray-server, or
/// http(s)://HOST/PATH/heights.pmtiles of any server that answers range requests. A directory needs neither a server
/// nor libcurl.
///
/// @param diskCache  for an address: what was fetched, kept from run to run
/// Throws as openLocalDataset and openWebDataset; for an address Error(unsupported) in a build without libcurl, for a
/// directory with a disk cache Error(usage).
[[nodiscard]] std::unique_ptr<TileSource> openDataset(const std::string& place, const DiskCacheOptions& diskCache = {});

}  // namespace terray
