#include "tests/stream/written_dataset.h"

#include <algorithm>

namespace terray::test {
namespace {

template <class Tiles, class Encode>
void writeArchive(const std::filesystem::path& path, const Tiles& tiles, const DatasetMetadata& metadata,
                  size_t leafEntries, Encode encode) {
    std::vector<TileId> ids;
    uint8_t finest = 0;
    for (const auto& [id, tile] : tiles) {
        ids.push_back(id);
        finest = std::max(finest, static_cast<uint8_t>(id.level));
    }
    std::sort(ids.begin(), ids.end(), [](const TileId& a, const TileId& b) { return hilbertId(a) < hilbertId(b); });
    PmtilesWriter::Options options;
    if (leafEntries < tiles.size()) options = {.maxRootBytes = 200, .leafEntries = leafEntries};
    PmtilesWriter writer(path, options);
    for (const TileId& id : ids) writer.add(id, encode(tiles.at(id)));
    writer.finish(toJson(metadata).dump(), {.minZoom = 0, .maxZoom = finest});
}

}  // namespace

void writeDataset(const FakeDataset& dataset, const std::filesystem::path& directory, size_t leafEntries) {
    writeArchive(directory / kHeightsFile, dataset.heights, dataset.metadata, leafEntries, encodeHeightTile);
    if (dataset.metadata.imageryLevel)
        writeArchive(directory / kImageryFile, dataset.imagery, dataset.metadata, leafEntries, encodeImageryTile);
}

}  // namespace terray::test
