#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/bytes.h"
#include "common/dataset_metadata.h"
#include "common/json.h"

namespace terray {

/// What a build is of: the heading of its journal. Two runs of equal headings make the same tiles, block by block.
struct BuildHeading {
    std::string program;        ///< version and commit of terray-preprocess
    Json dataset;               ///< its metadata as far as they are known before any block: options, sources, grid, ...
    uint32_t heightDepth = 0;   ///< levels in a block; a later run takes these over whatever its jobs and memory
    uint32_t imageryDepth = 0;  ///< 0 without imagery
};

/// The heading of a build by this program. @param metadata  without what only the build itself finds out
[[nodiscard]] BuildHeading makeHeading(const DatasetMetadata& metadata, uint32_t heightDepth, uint32_t imageryDepth);

[[nodiscard]] Bytes encodeHeading(const BuildHeading& heading);
/// Fails for what is no heading, or one of another version of the journal.
[[nodiscard]] Result<BuildHeading> decodeHeading(ByteView bytes);

/// What differs between the build that was begun and the one asked for now, one sentence each, naming options and
/// files; empty when the one can go on with the other. Depths may differ.
[[nodiscard]] std::vector<std::string> changesSince(const BuildHeading& begun, const BuildHeading& now);

}  // namespace terray
