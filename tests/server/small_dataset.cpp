#include "tests/server/small_dataset.h"

#include <functional>

#include <fcntl.h>
#include <unistd.h>

#include "common/check.h"
#include "common/dataset_metadata.h"
#include "common/pmtiles.h"
#include "tests/common/temporary_directory.h"

namespace terray::server {
namespace {

DatasetMetadata smallMetadata(bool withImagery) {
    DatasetMetadata metadata;
    metadata.tiling = {.west = 500000, .north = 5200000, .finestSpacing = 2, .finestLevel = kSmallLevel};
    metadata.samples = {2000, 2000};
    metadata.crsName = "EPSG:32632";
    metadata.lonLatBounds = GroundRect{9, 46.5, 9.1, 46.6};
    metadata.levelErrors = {8, 4, 0};
    metadata.tool = "tests";
    if (withImagery) metadata.imageryLevel = kSmallLevel + 1;
    return metadata;
}

void writeArchive(const std::filesystem::path& directory, const std::string& layer, uint32_t finestLevel,
                  const std::string& metadata, const std::function<std::string(const TileId&)>& tileOf) {
    PmtilesWriter writer(directory / (layer + ".pmtiles"));
    const uint64_t tiles = hilbertId({finestLevel + 1, 0, 0});  // all of the levels above come before it
    for (uint64_t hilbert = 0; hilbert < tiles; ++hilbert) {
        const TileId id = tileFromHilbert(hilbert).value();
        if (kEmptyTile.covers(id)) continue;
        const std::string tile = tileOf(id);
        writer.add(id, std::as_bytes(std::span(tile)));
    }
    writer.finish(metadata, {.maxZoom = static_cast<uint8_t>(finestLevel)});
}

}  // namespace

std::string smallTile(const std::string& layer, const TileId& id, int edition) {
    std::string text = layer + " " + toString(id) + " edition " + std::to_string(edition) + " ";
    while (text.size() < 300 + 7 * id.x) text += static_cast<char>(text.size() * 31 + id.y);
    return text;
}

void writeSmallDataset(const std::filesystem::path& directory, bool withImagery, int edition,
                       const std::string& suffix) {
    std::filesystem::create_directories(directory);
    const std::string metadata = toJson(smallMetadata(withImagery)).dump();
    const auto tilesOf = [&](const std::string& layer) {
        return [&suffix, layer, edition](const TileId& id) { return smallTile(layer, id, edition) + suffix; };
    };
    if (withImagery) writeArchive(directory, "imagery", kSmallLevel + 1, metadata, tilesOf("imagery"));
    writeArchive(directory, "heights", kSmallLevel, metadata, tilesOf("heights"));
}

void growHeights(const std::filesystem::path& directory, uint64_t size, uint64_t offset, const std::string& text) {
    const int file = ::open((directory / kHeightsFile).c_str(), O_WRONLY | O_CLOEXEC);
    TERRAY_CHECK_OP(file, >=, 0);
    TERRAY_CHECK_OP(::ftruncate(file, static_cast<off_t>(size)), ==, 0);
    const auto written = ::pwrite(file, text.data(), text.size(), static_cast<off_t>(offset));
    TERRAY_CHECK_OP(written, ==, static_cast<ssize_t>(text.size()));
    ::close(file);
}

std::string readText(const std::filesystem::path& path) {
    const Bytes bytes = test::readFile(path);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace terray::server
