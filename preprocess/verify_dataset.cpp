#include "preprocess/verify_dataset.h"

#include <algorithm>
#include <string>
#include <unordered_set>

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

TileList listTiles(const PmtilesReader& archive) {
    TileList list;
    std::unordered_set<uint64_t> offsets;
    uint64_t nextInRun = 0;
    uint64_t runOffset = 0;
    const auto listed = archive.forEach([&](const TileId& id, uint64_t offset, uint32_t) {
        const uint64_t hilbert = hilbertId(id);
        if (list.tiles.empty() || hilbert != nextInRun || offset != runOffset) ++list.entries;
        nextInRun = hilbert + 1;
        runOffset = offset;
        offsets.insert(offset);
        list.tiles.push_back(id);
    });
    if (!listed.ok()) throw Error(ExitCode::dataset, listed.failure().message);
    list.contents = offsets.size();
    return list;
}

void verifyHeader(const DatasetArchives& dataset, const PmtilesReader& archive, uint32_t finestLevel,
                  const TileList& list, FaultList& faults) {
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
    require(found.rootOffset == kPmtilesHeaderBytes && found.metadataOffset == found.rootOffset + found.rootLength &&
                found.leavesOffset == found.metadataOffset + found.metadataLength &&
                found.tilesOffset == found.leavesOffset + found.leavesLength &&
                archive.source().size() == found.tilesOffset + found.tilesLength,
            "the header's sections do not follow each other to the end of the file");
    require(found.clustered, "the header does not say that tiles lie in the order of their ids");
    require(found.addressedTiles == list.tiles.size() && found.tileEntries == list.entries &&
                found.tileContents == list.contents,
            "the header counts " + std::to_string(found.addressedTiles) + " tiles, " +
                std::to_string(found.tileEntries) + " entries and " + std::to_string(found.tileContents) +
                " contents, the directories " + std::to_string(list.tiles.size()) + ", " +
                std::to_string(list.entries) + " and " + std::to_string(list.contents));
}

VerifyReport verifyDataset(const DatasetArchives& dataset, int jobs, const std::atomic<bool>& stop) {
    FaultList faults;
    VerifyReport report;
    verifyMetadata(dataset.metadata, faults);
    // Members that no reader looks at count too: the text is the same in both archives, byte for byte.
    if (dataset.imagery && dataset.heights.metadata().value() != dataset.imagery->metadata().value())
        faults.add("the text of the metadata differs between the two archives");
    report.heightTiles = verifyHeights(dataset, jobs, stop, faults);
    if (dataset.imagery) report.imageryTiles = verifyImagery(dataset, jobs, stop, faults);
    report.faults = faults.sorted();
    return report;
}

}  // namespace terray
