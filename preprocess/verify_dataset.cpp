#include "preprocess/verify_dataset.h"

#include "common/error.h"
#include "preprocess/dataset_builder.h"
#include "preprocess/verify_faults.h"

namespace terray {
namespace {

void verifyMetadata(const DatasetMetadata& metadata, FaultList& faults) {
    const GridSize samples = metadata.samples;
    if (Tiling::levelFor(std::max(samples.width, samples.height)) != metadata.tiling.finestLevel)
        faults.add("finestLevel is " + std::to_string(metadata.tiling.finestLevel) + ", which does not fit " +
                   std::to_string(samples.width) + " x " + std::to_string(samples.height) + " samples");
}

}  // namespace

std::vector<TileId> listTiles(const PmtilesReader& archive) {
    std::vector<TileId> tiles;
    const auto listed = archive.forEach([&](const TileId& id, uint64_t, uint32_t) { tiles.push_back(id); });
    if (!listed.ok()) throw Error(ExitCode::dataset, listed.failure().message);
    return tiles;
}

void verifyHeader(const DatasetArchives& dataset, const PmtilesReader& archive, uint32_t finestLevel, uint64_t tiles,
                  FaultList& faults) {
    const PmtilesHeader& found = archive.header();
    const std::string name = archive.source().name();
    // Through the coding, since degrees are stored in steps of 1e-7.
    const PmtilesHeader expected =
        decodePmtilesHeader(encodePmtilesHeader(archiveHeader(dataset.metadata, finestLevel))).value();
    const auto require = [&](bool holds, const std::string& what) {
        if (!holds) faults.add(name + ": " + what);
    };
    require(found.minZoom == expected.minZoom && found.maxZoom == expected.maxZoom,
            "the header's zoom range is not 0 to " + std::to_string(finestLevel));
    require(found.minLon == expected.minLon && found.minLat == expected.minLat && found.maxLon == expected.maxLon &&
                found.maxLat == expected.maxLat,
            "the header's bounds are not those of the metadata");
    require(found.centerLon == expected.centerLon && found.centerLat == expected.centerLat &&
                found.centerZoom == expected.centerZoom,
            "the header's centre is not that of the bounds");
    require(found.tileType == 0 && found.tileCompression == PmtilesCompression::none,
            "the header's tile type or tile compression is not that of Terray's tiles");
    require(found.addressedTiles == tiles, "the header counts " + std::to_string(found.addressedTiles) +
                                               " tiles, the directories list " + std::to_string(tiles));
}

VerifyReport verifyDataset(const DatasetArchives& dataset, int jobs, const std::atomic<bool>& stop) {
    FaultList faults;
    VerifyReport report;
    verifyMetadata(dataset.metadata, faults);
    report.heightTiles = verifyHeights(dataset, jobs, stop, faults);
    if (dataset.imagery) report.imageryTiles = verifyImagery(dataset, jobs, stop, faults);
    report.faults = faults.sorted();
    return report;
}

}  // namespace terray
