#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "preprocess/dataset_archives.h"
#include "preprocess/dataset_builder.h"
#include "preprocess/raster_source.h"

namespace terray {

/// What of a dataset is to be taken.
struct DatasetPart {
    std::optional<GroundRect> bounds;     ///< metres in its coordinate system; none: all of the ground
    std::optional<uint32_t> finestLevel;  ///< levels beyond this one are left out, of heights and imagery alike
    std::function<void(const std::string&)> note;  ///< told what was decided
};

/// A dataset's own tiles as sources of another build.
struct DatasetSources {
    std::unique_ptr<HeightSource> heights;
    OpenPhoto openPhoto;  ///< empty when the part has no photo
};

/// Opens a part of a dataset: the samples of one level that touch `bounds`, and the photo over them.
///
/// Heights are the stored ones, to the bit; the photo is decoded from BC1, and texels without photo inside a stored
/// tile keep the neutral ground's colour as if they were photo. Where the photo is coarser than the heights, the part
/// grows to whole texels of it. Reading throws Error(dataset) for a damaged tile. Throws Error(usage) for a level that
/// the dataset lacks, Error(georeference) for bounds outside it.
[[nodiscard]] DatasetSources openDatasetPart(std::shared_ptr<const DatasetArchives> dataset, const DatasetPart& part);

}  // namespace terray
