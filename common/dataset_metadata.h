#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/json.h"
#include "common/result.h"
#include "common/tiling.h"

namespace terray {

/// Version of the dataset's format that this build writes; FORMAT.md describes it. Readers take exactly this one.
inline constexpr int kDatasetFormat = 1;
inline constexpr const char* kHeightsFile = "heights.pmtiles";
inline constexpr const char* kImageryFile = "imagery.pmtiles";

/// A file that went into a dataset.
struct SourceFile {
    std::string path;
    uint64_t bytes = 0;
    int64_t modifiedSeconds = 0;  ///< Unix time
    bool operator==(const SourceFile&) const = default;
};

/// What the JSON metadata of an archive says about the dataset: both archives of a dataset carry the same text.
struct DatasetMetadata {
    Tiling tiling;
    GridSize samples;                      ///< of the finest heights that the sources cover (unpadded)
    std::optional<uint32_t> imageryLevel;  ///< finest imagery level; none: no imagery.pmtiles
    std::optional<GroundRect> imageryBounds;

    std::string crsWkt;   ///< WKT2 of the coordinate system; empty: a plain image without one
    std::string crsName;  ///< for people, such as "EPSG:32613"
    /// West, south, east, north in degrees (WGS 84); absent without a coordinate system.
    std::optional<GroundRect> lonLatBounds;
    std::string verticalUnit = "metre";  ///< of the stored heights, always metres
    std::string verticalDatum = "unknown";

    double quantum = 0.01;  ///< metres, of HeightEncoding
    double minHeight = 0;   ///< metres, over the whole dataset, rounded down
    double maxHeight = 0;   ///< metres, rounded up
    std::string nodataPolicy = "holes";
    uint64_t holeSamples = 0;  ///< finest samples without surface inside `samples`
    uint64_t heightTiles = 0;
    uint64_t imageryTiles = 0;
    /// Measured greatest error of a tile of each level, level 0 first, metres: HeightRecord::error.
    std::vector<double> levelErrors;
    /// Whether tiles' errors bound their surfaces over all of the ground, as HeightTile::record says. False: an older
    /// build compared samples alone, and between them a bilinear surface may be off by more.
    bool errorsHoldEverywhere = true;
    /// Metres, >= 0: no finest height lies farther from what the sources said than this, half the widest step of codes
    /// there. How far the farthest does lie is measured: the last of levelErrors.
    double errorBound = 0;

    std::string tool;     ///< "terray-preprocess 0.1.0"
    std::string options;  ///< those that shape the result, as they were given
    std::vector<SourceFile> sources;

    bool operator==(const DatasetMetadata&) const = default;

    /// The ground that has samples (the root square without its padding).
    [[nodiscard]] GroundRect groundBounds() const;
};

[[nodiscard]] Json toJson(const DatasetMetadata& metadata);
/// Checks kinds and ranges; another format version fails with a message that says which versions this build reads.
[[nodiscard]] Result<DatasetMetadata> metadataFromJson(const Json& json);

}  // namespace terray
